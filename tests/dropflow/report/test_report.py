import json
import sys
from pathlib import Path

import numpy as np
import pytest

from dropflow.cli import main
from dropflow.errors import ExperimentError, ResultsError
from dropflow.physics.temperature_log import TemperatureLog
from dropflow.report.findings import Findings, find
from dropflow.report.page import write_report
from dropflow.report.sections import sections
from dropflow.report.words import methods_of, numbers_of, warnings_of
from dropflow.results import open_results
from tests.dropflow.report.conftest import SCENARIO, WAVES

KEYS = [
    "size-distribution-before",
    "size-distribution",
    "moments",
    "velocity-against-radius",
    "trajectory-length",
    "observed-depth",
    "radius-scatter",
    "growth",
    "coalescence",
    "flow-field",
    "flow-moments",
    "flow-correlation",
    "oscillations",
    "periods",
]


@pytest.fixture(scope="module")
def found(results_folder: Path) -> Findings:
    return find(open_results(results_folder))


def test_every_figure_of_the_paper_stands_in_the_report_with_data(results_folder: Path, found: Findings) -> None:
    made = sections(open_results(results_folder), found)
    assert [section.key for section in made] == KEYS
    for section in made:
        assert section.how
        assert len(section.figure.data) > 0 or section.key == "coalescence", section.key
        words = " ".join(annotation.text for annotation in section.figure.layout.annotations)
        assert "dropflow: " in words


def test_the_numbers_are_those_put_in(results_folder: Path, found: Findings) -> None:
    expected = SCENARIO.delta_density_kg_m3 / SCENARIO.viscosity_pa_s
    assert abs(found.calibration.deviation(expected)) < 3.5
    assert found.scatter.relative == pytest.approx(0.03, rel=0.2)
    true_s = np.diff(WAVES.starts_s[1:5])
    assert len(found.oscillations.period_s) == len(true_s)
    assert (np.abs(found.oscillations.period_s - true_s) < 3 * found.oscillations.period_std_s).all()
    numbers = numbers_of(open_results(results_folder), found)
    assert numbers["oscillations"] == "4"
    assert "581" not in numbers["trajectories"]


def test_the_page_needs_nothing_from_outside_and_takes_names_as_text(results_folder: Path, tmp_path: Path) -> None:
    write_report(open_results(results_folder), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "waves &lt;/script&gt;&lt;b&gt;&amp;" in page
    assert "waves </script>" not in page
    # plotly.js carries addresses of maps that are never drawn here; nothing else may name a server.
    ours = page.split("</script></head>")[1]
    assert "src=" not in ours
    assert 'href="http' not in ours
    assert page.count("<figure id=") == len(KEYS)
    assert not list(tmp_path.glob("*.part"))


def test_warnings_and_methods_are_plain_words(results_folder: Path, found: Findings) -> None:
    results = open_results(results_folder)
    assert any("observed depth is an estimate" in text for text in warnings_of(results, found))
    assert "detection: default" in methods_of(results, found)
    assert "Lapp" in methods_of(results, found)


def test_one_frame_gives_empty_labelled_figures(short_results: Path, tmp_path: Path) -> None:
    results = open_results(short_results)
    found = find(results)
    for section in sections(results, found):
        words = " ".join(annotation.text for annotation in section.figure.layout.annotations)
        assert section.figure.data or "no " in words or "fewer" in words or "too few" in words, section.key
    said = write_report(results, tmp_path / "report.html")
    assert any("only 0 trajectories" in text for text in said)
    assert "nan" not in json.dumps(numbers_of(results, found)).lower()


def test_periods_stand_against_temperature_where_a_log_is_given(results_folder: Path) -> None:
    log = TemperatureLog(np.array([0.0, 1000.0]), np.array([26.0, 30.0]))
    results = open_results(results_folder)
    made = {section.key: section.figure for section in sections(results, find(results, temperature=log))}
    assert "temperature" in made["periods"].layout.xaxis.title.text


def test_an_unknown_material_stops_the_report(results_folder: Path, tmp_path: Path) -> None:
    summary = json.loads((results_folder / "summary.json").read_text())
    summary["provenance"]["experiment"]["material"] = "unobtainium"
    other = tmp_path / "results"
    other.mkdir()
    for path in results_folder.iterdir():
        (other / path.name).symlink_to(path)
    (other / "summary.json").unlink()
    (other / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(ExperimentError, match="unobtainium"):
        find(open_results(other))


@pytest.mark.parametrize("content", [None, "words", "{}", '{"provenance": {"experiment": {}}}'])
def test_a_folder_without_results_is_one_line_and_exit_code_2(
    tmp_path: Path,
    content: str | None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if content is not None:
        (tmp_path / "summary.json").write_text(content)
    with pytest.raises((ResultsError, ExperimentError)):
        open_results(tmp_path)
    monkeypatch.setattr(sys, "argv", ["dropflow", "report", str(tmp_path), "-o", str(tmp_path / "report.html")])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "report.html").exists()
