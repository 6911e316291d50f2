import json
from pathlib import Path

import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

from dropflow.cli import app
from dropflow.errors import ResultsError
from dropflow.scoring import score_results
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import DENSE
from dropflow.simulation.write import write_experiment
from tests.dropflow.simulation.scenes import small


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("film") / "film"
    scenario = small(DENSE, height_px=400, width_px=400, collision_efficiency=1.0)
    write_experiment(out, Film(scenario, seed=1), 8, with_images=False)
    return out


@pytest.fixture
def results(film: Path, tmp_path: Path) -> Path:
    """What a perfect analysis would write."""
    folder = tmp_path / "results"
    folder.mkdir()
    seen = pl.read_parquet(film / "truth.parquet").filter(pl.col("visibility") == "visible")
    seen.write_parquet(folder / "droplets.parquet")
    seen.with_columns(trajectory_id="droplet_id").write_parquet(folder / "trajectories.parquet")
    (folder / "flow.zarr").symlink_to(film / "truth_flow.zarr")
    return folder


def test_a_perfect_analysis_scores_one_in_everything(film: Path, results: Path) -> None:
    report = score_results(results, film / "truth.parquet")
    assert report.missing == ()
    assert report.detection.f1 == report.tracked.f1 == 1
    assert (report.links.precision, report.links.recall) == (1, 1)
    assert (report.isbi.alpha, report.isbi.jsc_theta) == (1, 1)
    assert report.flow.error_over_rms == 0
    assert (report.sizes_before.l1, report.sizes_after.l1) == (0, 0)


def test_going_on_as_the_product_of_a_coalescence_is_no_wrong_link(film: Path, results: Path) -> None:
    events = pl.read_csv(film / "events.csv").filter(pl.col("kind") == "coalescence")
    products = dict(events.select("product_id", "droplet_id").iter_rows())
    names = {i: i for i in pl.read_parquet(results / "droplets.parquet")["droplet_id"]}
    names |= {product: parent for product, parent in products.items() if parent in names}
    tracks = pl.read_parquet(results / "trajectories.parquet")
    tracks.with_columns(pl.col("trajectory_id").replace(names)).write_parquet(results / "trajectories.parquet")
    links = score_results(results, film / "truth.parquet").links
    assert (links.precision, links.recall) == (1, 1)
    assert links.n_neutral > 0


@pytest.mark.parametrize(("about", "l1"), [("{}", 1.0), ('{"tracking": {"count_out_of_focus": true}}', 0.0)])
def test_droplets_out_of_focus_count_as_the_parameters_say(film: Path, results: Path, about: str, l1: float) -> None:
    path = results / "trajectories.parquet"
    rows = pq.read_table(path)
    rows = rows.append_column("is_in_focus", pa.array([False] * len(rows)))
    pq.write_table(rows.replace_schema_metadata({"dropflow": f'{{"parameters": {about}}}'}), path)
    assert score_results(results, film / "truth.parquet").sizes_after.l1 == l1


def test_what_is_there_is_scored_and_what_is_not_is_said(film: Path, results: Path) -> None:
    for name in ("trajectories.parquet", "flow.zarr"):
        (results / name).unlink()
    report = score_results(results, film / "truth.parquet")
    assert report.detection.f1 == 1
    assert (report.links, report.flow) == (None, None)
    assert report.missing == ("trajectories.parquet", "flow.zarr")


def test_a_single_table_of_droplets_is_enough(film: Path, results: Path) -> None:
    report = score_results(results / "droplets.parquet", film / "truth.parquet")
    assert report.detection.f1 == 1
    assert report.links is None


@pytest.mark.parametrize("name", ["nowhere", ".", "broken.parquet"])
def test_results_that_are_none_are_an_error(film: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / "broken.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(ResultsError):
        score_results(tmp_path / name, film / "truth.parquet")


def test_a_missing_truth_is_an_error(film: Path, results: Path) -> None:
    with pytest.raises(ResultsError, match="no such file"):
        score_results(results, film / "nothing.parquet")


def test_the_command_prints_the_numbers_as_a_table_and_as_json(film: Path, results: Path) -> None:
    (results / "flow.zarr").unlink()
    command = ["score", str(results), "--truth", str(film / "truth.parquet")]
    shown = CliRunner().invoke(app, command)
    assert shown.exit_code == 0
    assert "precision any" in shown.output
    assert "Not there, so not scored: flow.zarr" in shown.output
    printed = CliRunner().invoke(app, [*command, "--json"])
    report = json.loads(printed.stdout)
    assert report["detection"]["f1"] == 1
    assert report["missing"] == ["flow.zarr"]
