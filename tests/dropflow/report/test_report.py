import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import zarr

from dropflow.cli import main
from dropflow.errors import ExperimentError, ResultsError
from dropflow.figures.catalogue import BY_NAME, CATALOGUE
from dropflow.figures.entry import Group, draw
from dropflow.figures.example import WORKING_PANELS
from dropflow.physics.temperature_log import TemperatureLog
from dropflow.report.frames import FrameSource
from dropflow.report.page import write_report
from dropflow.report.sections import sections
from dropflow.report.words import methods_of, numbers_of, warnings_of
from dropflow.results import Results, open_results
from dropflow.statistics.findings import Findings
from dropflow.statistics.summary import statistics_of
from tests.dropflow.report.conftest import SCENARIO, WAVES

KEYS = [entry.name for entry in CATALOGUE if entry.group is not Group.FLUID and entry.name not in WORKING_PANELS]
KEYS = [name for name in KEYS if name not in ("temperature", "driving")]
"""Of an experiment with a fixed material and no log, and results without images."""


def find(results: Results, temperature: TemperatureLog | None = None) -> Findings:
    return Findings(results.facts, results.condensed, temperature=temperature)


def source_of(results: Results) -> FrameSource:
    return FrameSource(results.trajectories, results.flow, results.example)


@pytest.fixture(scope="module")
def found(results_folder: Path) -> Findings:
    return find(open_results(results_folder))


def test_every_figure_of_the_paper_stands_in_the_report_with_data(results_folder: Path, found: Findings) -> None:
    made = sections(found, source_of(open_results(results_folder)))
    assert [section.key for section in made] == KEYS
    for section in made:
        assert section.how
        assert len(section.figure.data) > 0 or section.key == "coalescence", section.key
        words = " ".join(annotation.text for annotation in section.figure.layout.annotations)
        assert "dropflow: " in words


def test_the_numbers_are_those_put_in(results_folder: Path, found: Findings) -> None:
    assert found.calibration.expected_s_m2 == pytest.approx(SCENARIO.delta_density_kg_m3 / SCENARIO.viscosity_pa_s)
    assert abs(found.calibration.deviation) < 3.5
    assert abs(found.scatter.relative - 0.03) < 4 * found.scatter.relative_std
    assert found.scatter.relative_std < 0.003
    true_s = np.diff(WAVES.starts_s[1:5])
    assert len(found.oscillations.period_s) == len(true_s)
    assert (np.abs(found.oscillations.period_s - true_s) < 3 * found.oscillations.period_std_s).all()
    numbers = numbers_of(found, open_results(results_folder).summary)
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
    assert any("observed depth is an estimate" in text for text in warnings_of(found, results.summary))
    assert "detection: default" in methods_of(found, results.summary)
    assert "Lapp" in methods_of(found, results.summary)


def test_one_frame_gives_empty_labelled_figures(short_results: Path, tmp_path: Path) -> None:
    results = open_results(short_results)
    found = find(results)
    for section in sections(found, source_of(results)):
        words = " ".join(annotation.text for annotation in section.figure.layout.annotations)
        assert section.figure.data or "no " in words or "fewer" in words or "too few" in words or "unknown" in words, (
            section.key
        )
    said = write_report(results, tmp_path / "report.html")
    assert any("only 0 trajectories" in text for text in said)
    assert "nan" not in json.dumps(numbers_of(found, results.summary)).lower()


def test_periods_stand_against_temperature_where_a_log_is_given(results_folder: Path) -> None:
    log = TemperatureLog(np.array([0.0, 1000.0]), np.array([26.0, 30.0]))
    results = open_results(results_folder)
    made = {section.key: section.figure for section in sections(find(results, log), source_of(results))}
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
        _ = find(open_results(other)).material


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


@pytest.mark.parametrize("words", [["--frame", "3"], ["--stack", "frames"]])
def test_another_frame_needs_the_stack(
    results_folder: Path, words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["dropflow", "report", str(results_folder), *words])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    assert "--frame and --stack together" in capsys.readouterr().err


def test_a_flow_without_a_computed_cell_is_said_and_never_a_number(results_folder: Path, tmp_path: Path) -> None:
    shutil.copytree(results_folder, tmp_path / "other")
    zarr.open_array(tmp_path / "other" / "flow.zarr" / "is_interpolated", mode="r+")[:] = True
    found = find(open_results(tmp_path / "other"))
    for name in ("flow_moments", "flow_bins", "flow_correlation"):
        figure = draw(BY_NAME[name], found)
        assert not [trace for trace in figure.data if trace.x is not None and len(trace.x)], name
        assert any("no flow" in note.text for note in figure.layout.annotations), name
    said = statistics_of(found)
    assert said["correlation_length_um"] is None
    json.dumps(said, allow_nan=False)
