import csv
from pathlib import Path

import numpy as np
import polars as pl
import pyarrow.parquet as pq
import pytest
import tifffile
import yaml
import zarr

from dropflow.errors import Cancelled, ParametersError, ResultsError
from dropflow.experiment import load_experiment
from dropflow.simulation.cloud import Cloud
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import DENSE, EASY, FAST
from dropflow.simulation.truth import TRUTH
from dropflow.simulation.write import render_positions, write_experiment
from tests.dropflow.simulation.scenes import clean, cloud, small

N_FRAMES = 4


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("film") / "dense"
    write_experiment(out, Film(small(DENSE, nucleation_per_s=200), seed=7), N_FRAMES)
    return out


def _contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_folder_holds_what_the_contract_says(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "frames",
        "flat_field.tif",
        "truth.parquet",
        "truth_flow.zarr",
        "events.csv",
        "experiment.yaml",
        "scenario.yaml",
    }
    frames = sorted((folder / "frames").iterdir())
    assert [path.name for path in frames] == [f"frame_{i:06d}.tif" for i in range(N_FRAMES)]
    for path in [*frames, folder / "flat_field.tif"]:
        image = tifffile.imread(path)
        assert (image.shape, image.dtype) == ((192, 240), np.uint8)


def test_the_experiment_is_valid_and_names_the_flat_field(folder: Path) -> None:
    experiment = load_experiment(folder / "experiment.yaml")
    assert (experiment.flat_field, experiment.pixel_size_um, experiment.frame_interval_s) == (
        "flat_field.tif",
        0.625,
        1,
    )
    assert experiment.material.delta_density_kg_m3 == -30
    scenario = yaml.safe_load((folder / "scenario.yaml").read_text())
    assert (scenario["seed"], scenario["n_frames"], scenario["scenario"]["n_droplets"]) == (7, N_FRAMES, 1000)


def test_the_truth_has_every_frame_in_order(folder: Path) -> None:
    table = pq.read_table(folder / "truth.parquet")
    assert table.schema == TRUTH
    rows = pl.from_arrow(table)
    assert rows["frame"].is_sorted()
    assert rows["frame"].unique().to_list() == list(range(N_FRAMES))
    assert rows.select(pl.struct("frame", "droplet_id").is_unique().all()).item()


def test_the_true_flow_is_that_at_the_centres_of_cells_between_frames(folder: Path) -> None:
    store = zarr.open_group(folder / "truth_flow.zarr", mode="r")
    film = Film(small(DENSE, nucleation_per_s=200), seed=7)
    assert store["velocity_um_s"].shape == (N_FRAMES - 1, 2, 20, 25)
    x_um, y_um = store["grid_x_px"][:] * 0.625, store["grid_y_px"][:] * 0.625
    exact = film.flow.velocity_um_s(np.array([x_um[24]]), np.array([y_um[19]]), 1.5)
    assert store["velocity_um_s"][1, :, 19, 24] == pytest.approx(exact[:2, 0], rel=1e-5)
    assert not store["is_interpolated"][:].any()
    assert np.all(store["velocity_std_um_s"][:] == 0)
    truth = pl.read_parquet(folder / "truth.parquet").filter(pl.col("visibility") == "visible", pl.col("frame") == 2)
    assert store["droplet_count"][2].sum() == len(truth)


def test_frames_show_the_droplets_where_the_truth_has_them(folder: Path) -> None:
    truth = pl.read_parquet(folder / "truth.parquet").filter(pl.col("visibility") == "visible", pl.col("frame") == 3)
    frame = tifffile.imread(folder / "frames" / "frame_000003.tif").astype(float)
    x, y = (truth[name].to_numpy().round().astype(int).clip(0, limit) for name, limit in (("x_px", 239), ("y_px", 191)))
    assert len(truth) > 3
    assert np.all(frame[y, x] > np.median(frame) + 4)


def test_events_explain_every_droplet_that_comes_or_goes(folder: Path) -> None:
    with (folder / "events.csv").open() as file:
        events = list(csv.DictReader(file))
    rows = pl.read_parquet(folder / "truth.parquet")
    ids = [set(rows.filter(pl.col("frame") == frame)["droplet_id"]) for frame in range(N_FRAMES)]
    for frame in range(1, N_FRAMES):
        here = [event for event in events if int(event["frame"]) == frame]
        merges = [event for event in here if event["kind"] == "coalescence"]
        born = {int(e["droplet_id"]) for e in here if e["kind"] == "birth"} | {int(e["product_id"]) for e in merges}
        gone = {int(e["droplet_id"]) for e in here if e["kind"] == "exit"}
        gone |= {int(e[name]) for e in merges for name in ("droplet_id", "other_id")}
        assert ids[frame] - ids[frame - 1] <= born
        assert ids[frame - 1] - ids[frame] <= gone
    causes = {(event["kind"], event["cause"]) for event in events}
    assert {("birth", "border"), ("birth", "nucleation"), ("exit", "border")} <= causes


def test_the_same_seed_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    write_experiment(tmp_path / "again", Film(small(DENSE, nucleation_per_s=200), seed=7), N_FRAMES)
    assert _contents(tmp_path / "again") == _contents(folder)


def test_another_seed_gives_another_film(folder: Path, tmp_path: Path) -> None:
    write_experiment(tmp_path / "other", Film(small(DENSE, nucleation_per_s=200), seed=8), 1)
    other = tifffile.imread(tmp_path / "other" / "frames" / "frame_000000.tif")
    assert not np.array_equal(other, tifffile.imread(folder / "frames" / "frame_000000.tif"))


def test_the_truth_without_images_is_the_same(folder: Path, tmp_path: Path) -> None:
    write_experiment(tmp_path / "o", Film(small(DENSE, nucleation_per_s=200), seed=7), N_FRAMES, with_images=False)
    assert not (tmp_path / "o" / "frames").exists()
    assert load_experiment(tmp_path / "o" / "experiment.yaml").flat_field is None
    assert pq.read_table(tmp_path / "o" / "truth.parquet").equals(pq.read_table(folder / "truth.parquet"))


def test_long_films_are_written_in_parts(tmp_path: Path) -> None:
    progress = []
    write_experiment(
        tmp_path / "long",
        Film(small(EASY), seed=1),
        70,
        with_images=False,
        progress=lambda stage, done, total: progress.append((stage, done, total)),
    )
    assert pq.ParquetFile(tmp_path / "long" / "truth.parquet").num_row_groups == 2
    assert zarr.open_group(tmp_path / "long" / "truth_flow.zarr", mode="r")["velocity_um_s"].shape[0] == 69
    assert progress[-1] == ("simulate", 70, 70)
    flow = zarr.open_group(tmp_path / "long" / "truth_flow.zarr", mode="r")["velocity_um_s"]
    assert np.isfinite(flow[:]).all()


def test_a_single_frame_has_no_step_of_flow(tmp_path: Path) -> None:
    write_experiment(tmp_path / "one", Film(small(EASY), seed=1), 1)
    assert zarr.open_group(tmp_path / "one" / "truth_flow.zarr", mode="r")["velocity_um_s"].shape == (0, 2, 20, 25)


def test_an_existing_film_is_not_overwritten(folder: Path) -> None:
    before = _contents(folder)
    with pytest.raises(ResultsError, match="there already") as caught:
        write_experiment(folder, Film(small(EASY), seed=1), 1)
    assert caught.value.code == "results.exists"
    assert _contents(folder) == before


def test_no_frames_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ParametersError, match="frames: must be at least 1"):
        write_experiment(tmp_path / "none", Film(small(EASY), seed=1), 0)


@pytest.mark.parametrize("scenario", [small(EASY), small(EASY, contrast_levels=1.0)], ids=["cancelled", "invisible"])
def test_nothing_is_left_of_a_film_that_fails(tmp_path: Path, scenario: object) -> None:
    def stop(stage: str, done: int, total: int) -> None:
        raise Cancelled("Stopped.")

    with pytest.raises((Cancelled, ParametersError)):
        write_experiment(tmp_path / "film", Film(scenario, seed=1), 3, progress=stop)
    assert list(tmp_path.iterdir()) == []


def test_droplets_can_be_rendered_on_given_paths(tmp_path: Path) -> None:
    def at(frame: int) -> Cloud:
        return cloud((40.0 + 3 * frame, 50.0, 0, 8), (100.0, 60.0 - 5 * frame, 0, 12))

    scenario = clean(frame_interval_s=0.5, viscosity_pa_s=1e-3, delta_density_kg_m3=-30)
    render_positions(
        tmp_path / "paths",
        scenario,
        (at(frame) for frame in range(3)),
        3,
        seed=0,
        flow_at=lambda time_s: np.full((2, 20, 25), time_s),
    )
    rows = pl.read_parquet(tmp_path / "paths" / "truth.parquet")
    assert rows["x_um"].to_list() == [40, 100, 43, 100, 46, 100]
    assert rows["u_um_s"].to_list() == pytest.approx([6, 0] * 3)
    assert rows["v_um_s"].to_list() == pytest.approx([0, -10] * 3)
    assert rows["flow_v_um_s"].to_list() == pytest.approx((rows["v_um_s"] + rows["sedimentation_um_s"]).to_list())
    frame = tifffile.imread(tmp_path / "paths" / "frames" / "frame_000002.tif")
    assert np.unravel_index(frame.argmax(), frame.shape) == pytest.approx((80, 160), abs=1.5)
    flow = zarr.open_group(tmp_path / "paths" / "truth_flow.zarr", mode="r")["velocity_um_s"][:]
    assert flow[:, 0, 0, 0] == pytest.approx([0.25, 0.75])


def test_fast_droplets_that_cross_the_frame_in_a_few_steps_leave_over_the_border(tmp_path: Path) -> None:
    write_experiment(tmp_path / "fast", Film(small(FAST), seed=3), 6, with_images=False)
    events = pl.read_csv(tmp_path / "fast" / "events.csv")
    large = events.filter((pl.col("kind") == "exit") & (pl.col("r_px") > 32))
    assert len(large) > 0
    assert large["cause"].to_list() == ["border"] * len(large)
