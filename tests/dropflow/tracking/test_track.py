import json
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
import zarr

from dropflow.droplets import Droplets
from dropflow.errors import Cancelled, ExperimentError, ResultsError
from dropflow.tables import TRAJECTORIES
from dropflow.tracking.film import FRAMES_PER_PART
from dropflow.tracking.filtering import Reason
from dropflow.tracking.sizes import REJECTED
from tests.dropflow.tracking.generated import Film, experiment, film, vortices
from tests.dropflow.tracking.tracked import link_scores, long_film, read, tracked

ROOT = Path(__file__).parents[3]


@pytest.fixture(params=["default", "paper"])
def method(request: pytest.FixtureRequest) -> str:
    """Every test here holds for both ways of tracking."""
    return str(request.param)


def contents(folder: Path) -> dict[str, bytes]:
    """Every byte of the results."""
    names = ("trajectories.parquet", "rejected_trajectories.parquet", "events.parquet")
    files = [folder / name for name in names] + sorted(p for p in (folder / "flow.zarr").rglob("*") if p.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_links_of_perfect_detections_are_right(method: str, tmp_path: Path) -> None:
    """A flow that moves droplets by half their spacing in a step, and Stokes' law on top."""
    given = film(flow=vortices(15, 300, drift_px_s=(10, 5)))
    precision, recall = link_scores(given, read(tracked(given, tmp_path, method)))
    assert precision > 0.99
    assert recall > 0.97


def test_false_and_missing_detections_cost_little_precision(method: str, tmp_path: Path) -> None:
    """One in ten droplets missing, one in five detections false, radii 4 % off."""
    given = film(flow=vortices(10, 300), found_share=0.9, n_false=25, radius_error=0.04)
    precision, recall = link_scores(given, read(tracked(given, tmp_path, method)))
    assert precision > 0.93
    assert recall > 0.8


def test_uneven_intervals_are_no_obstacle(method: str, tmp_path: Path) -> None:
    """Velocities are per second, and predictions use the interval of each step."""
    intervals = np.array([1.0, 0.3, 2.0, 0.5, 1.5, 1.0, 0.2, 2.0, 1.0])
    given = film(flow=vortices(8, 300, drift_px_s=(8, 0)), n_frames=10, interval_s=intervals)
    result = tracked(given, tmp_path, method)
    precision, recall = link_scores(given, read(result))
    assert precision > 0.98
    assert recall > 0.95
    drift = np.array(result.drift_um_s) / given.experiment.pixel_size_um
    np.testing.assert_allclose(drift, [8, 0], atol=2)


def test_the_table_of_trajectories_keeps_its_contract(method: str, tmp_path: Path) -> None:
    """Columns, order, units; velocities are towards the next frame, in the last row from the one before."""
    given = film(flow=vortices(8, 300), n_frames=6)
    table = read(tracked(given, tmp_path, method, made_by="a test"))
    assert table.schema.remove_metadata() == TRAJECTORIES
    assert json.loads(table.schema.metadata[b"dropflow"]) == {"made_by": "a test"}
    ids, frames = table["trajectory_id"].to_numpy(), table["frame"].to_numpy()
    assert (np.lexsort((frames, ids)) == np.arange(len(ids))).all()
    same = ids[:-1] == ids[1:]
    assert (frames[1:][same] == frames[:-1][same] + 1).all()
    x_um, u, time_s = (table[name].to_numpy() for name in ("x_um", "u_um_s", "time_s"))
    np.testing.assert_allclose(u[:-1][same], (np.diff(x_um) / np.diff(time_s))[same], atol=1e-9)
    is_last = np.append(~same, True)
    np.testing.assert_array_equal(u[is_last], u[:-1][is_last[1:]])
    np.testing.assert_allclose(x_um, table["x_px"].to_numpy() * given.experiment.pixel_size_um)
    assert (table["sedimentation_um_s"].to_numpy() > 0).all()


def test_each_detection_is_in_one_trajectory_kept_or_rejected(method: str, tmp_path: Path) -> None:
    """No branches, nothing lost: rows of kept and rejected trajectories add up to all detections."""
    given = long_film()
    result = tracked(given, tmp_path, method)
    table, rejected = read(result), pq.read_table(result.rejected)
    places = list(zip(*(table[name].to_pylist() for name in ("frame", "x_px", "y_px")), strict=True))
    assert len(set(places)) == len(places)
    assert rejected.schema.remove_metadata() == REJECTED
    n_detected = pc.sum(table["is_detected"]).as_py() + pc.sum(rejected["n_detected"]).as_py()
    assert n_detected == sum(len(droplets) for droplets in given.frames)
    kept_ids, rejected_ids = set(table["trajectory_id"].to_pylist()), rejected["trajectory_id"].to_pylist()
    assert not kept_ids & set(rejected_ids)
    assert kept_ids | set(rejected_ids) == set(range(len(kept_ids) + len(rejected_ids)))
    assert rejected_ids == sorted(rejected_ids)
    assert result.n_trajectories == len(kept_ids)
    assert result.n_rejected == dict.fromkeys(Reason, 0) | Counter(rejected["reason"].to_pylist())


def test_dirt_is_no_trajectory(method: str, tmp_path: Path) -> None:
    """Where the fluid drifts, what stays where it is was no droplet."""
    given = film(flow=vortices(2, 300, drift_px_s=(6, 0)), n_frames=8)
    spot = replace(given.frames[0][:1], x_px=np.array([300.0]), y_px=np.array([200.0]), r_px=np.array([7.0]))
    frames = [Droplets.concatenate([droplets, spot]) for droplets in given.frames]
    result = tracked(replace(given, frames=frames), tmp_path, method)
    assert (300.0, 200.0) not in zip(*(read(result)[name].to_pylist() for name in ("x_px", "y_px")), strict=True)
    rejected = pq.read_table(result.rejected).filter(pc.field("x_px") == 300.0)
    assert set(rejected["reason"].to_pylist()) == ({"stationary"} if method == "paper" else {"short", "brief"})
    assert pc.sum(rejected["weight"]).as_py() <= 1.0  # of 8 frames: at the ends of the film, and there in part


def test_the_flow_is_stored_for_each_step(method: str, tmp_path: Path) -> None:
    """The layout that others rely on, and values near the true flow where cells were computed."""
    true = vortices(8, 300, drift_px_s=(5, 0))
    given = film(flow=true, n_frames=40, n_droplets=200)
    store = zarr.open_group(tracked(given, tmp_path, method, flow={"n_columns": 9, "n_rows": 7}).flow, mode="r")
    velocity, is_interpolated = store["velocity_um_s"], store["is_interpolated"]
    assert velocity.shape == store["velocity_std_um_s"].shape == (39, 2, 7, 9)
    assert store["droplet_count"].shape == is_interpolated.shape == (39, 7, 9)
    assert velocity.metadata.dimension_names == ("frame", "component", "row", "column")
    assert velocity.attrs["units"] == "um/s"
    x, y = np.meshgrid(store["grid_x_px"][:], store["grid_y_px"][:])
    for step in (0, 31, 32, 38):
        expected = true(x.ravel(), y.ravel(), given.times_s[step]).reshape(2, 7, 9) * given.experiment.pixel_size_um
        computed = ~is_interpolated[step]
        error = (velocity[step] - expected)[:, computed]
        assert np.sqrt((error**2).mean()) < 0.35 * np.sqrt((expected**2).mean())
    assert store["droplet_count"][:].sum(axis=(1, 2)).min() > 50


def test_killed_at_any_moment_it_goes_on_to_the_same_bytes(method: str, tmp_path: Path) -> None:
    """SIGKILL in each pass; the process started again continues where the last checkpoint was.

    The child kills itself: one killed from outside may, on a busy machine, have finished before.
    """
    tracked(long_film(), tmp_path / "undisturbed", method)
    command = [sys.executable, "-m", "tests.dropflow.tracking.tracked", str(tmp_path / "killed"), method]
    starts = []
    for dies_at in (FRAMES_PER_PART + 20, 180, 300):
        child = subprocess.run([*command, str(dies_at)], cwd=ROOT, capture_output=True, text=True)
        assert child.returncode == -signal.SIGKILL, child.stderr
        starts.append(int(child.stdout))
    child = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    start, end = map(int, child.stdout.split())
    assert end == 440
    starts.append(start)
    assert starts[0] == 0
    assert all(start > 0 for start in starts[1:])
    assert starts == sorted(starts)
    assert contents(tmp_path / "killed") == contents(tmp_path / "undisturbed")


def test_finished_work_is_not_done_again(method: str, tmp_path: Path) -> None:
    """Called again with the same input it returns the same result at once; with another it starts anew."""
    given = film(flow=vortices(8, 300), n_frames=6)
    first = tracked(given, tmp_path, method)
    before = contents(tmp_path)
    assert tracked(replace(given, frames=[]), tmp_path, method) == first
    assert contents(tmp_path) == before
    assert tracked(given, tmp_path, method, shortest_trajectory_frames=6).n_trajectories < first.n_trajectories


def test_progress_grows_to_its_total_and_may_stop_the_work(method: str, tmp_path: Path) -> None:
    """One count over all passes; what the callback raises comes through, and the work can go on later."""
    given = film(flow=vortices(8, 300), n_frames=6)
    seen = []
    tracked(given, tmp_path / "a", method, progress=lambda stage, done, total: seen.append((stage, done, total)))
    assert {(stage, total) for stage, _, total in seen} == {("track", 24)}
    counts = [done for _, done, _ in seen]
    assert counts == sorted(counts)
    assert set(counts) >= set(range(19))
    assert counts[-1] == 24

    def stop(stage: str, done: int, total: int) -> None:
        if done == 8:
            raise Cancelled("Somebody cancelled.")

    with pytest.raises(Cancelled):
        tracked(given, tmp_path / "b", method, progress=stop)
    tracked(given, tmp_path / "b", method)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def still(frames: list[Droplets], times_s: list[float] | None = None) -> Film:
    """A film of given detections."""
    times = np.arange(float(len(frames))) if times_s is None else np.array(times_s)
    return Film(experiment(0.0), (512, 612), times, frames, [np.arange(len(droplets)) for droplets in frames])


def test_a_single_frame_has_no_trajectories_and_no_flow(method: str, tmp_path: Path) -> None:
    """All tables and arrays are there, empty, and every detection is rejected as short."""
    given = film(flow=vortices(8, 300), n_frames=1)
    result = tracked(given, tmp_path, method)
    assert len(read(result)) == 0
    assert zarr.open_group(result.flow, mode="r")["velocity_um_s"].shape == (0, 2, 20, 25)
    assert result.n_rejected == dict.fromkeys(Reason, 0) | {Reason.BRIEF: len(given.frames[0])}


def test_a_film_without_droplets_has_empty_results(method: str, tmp_path: Path) -> None:
    """The flow is not known anywhere."""
    result = tracked(still([Droplets.empty()] * 4), tmp_path, method)
    assert len(read(result)) == 0
    store = zarr.open_group(result.flow, mode="r")
    assert np.isnan(store["velocity_um_s"][:]).all()
    assert store["is_interpolated"][:].all()
    assert result.drift_um_s == (0.0, 0.0)


def test_empty_frames_inside_a_film_are_survived(method: str, tmp_path: Path) -> None:
    """Trajectories end before them and others begin after."""
    given = film(flow=vortices(8, 300), n_frames=12)
    frames = [*given.frames[:5], Droplets.empty(), *given.frames[6:]]
    truth = [*given.truth[:5], np.empty(0, np.int64), *given.truth[6:]]
    cut = replace(given, frames=frames, truth=truth)
    precision, recall = link_scores(cut, read(tracked(cut, tmp_path, method)))
    assert precision > 0.98
    assert recall > 0.93


def test_identical_frames_are_a_fluid_at_rest(method: str, tmp_path: Path) -> None:
    """Without density difference each droplet stays; none is lost, none is called dirt."""
    droplets = film(flow=vortices(0, 300), n_frames=1).frames[0]
    result = tracked(still([droplets] * 5), tmp_path, method)
    assert result.n_trajectories == len(droplets)
    assert len(read(result)) == 5 * len(droplets)


def test_all_detections_at_one_place_are_survived(method: str, tmp_path: Path) -> None:
    """However many there are, each is in one trajectory at most."""
    one = film(flow=vortices(0, 300), n_frames=1).frames[0][:1]
    heap = one[np.zeros(60, np.int64)]
    assert len(read(tracked(still([heap] * 4), tmp_path, method))) <= 4 * 60


@pytest.mark.parametrize("times", [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, float("nan"), 2.0]])
def test_time_that_does_not_go_forward_is_an_error(method: str, tmp_path: Path, times: list[float]) -> None:
    """It names the field and the frame."""
    with pytest.raises(ExperimentError) as caught:
        tracked(still([Droplets.empty()] * 3, times), tmp_path, method)
    assert caught.value.code == "experiment.times_not_increasing"
    assert caught.value.fields[0].field == "timestamps"


@pytest.mark.parametrize("column", ["x_px", "y_px", "r_px"])
def test_detections_that_are_no_numbers_are_an_error(method: str, tmp_path: Path, column: str) -> None:
    """It names the frame."""
    good = film(flow=vortices(0, 300), n_frames=1).frames[0][:3]
    bad = replace(good, **{column: np.array([1.0, np.nan, 2.0])})
    with pytest.raises(ResultsError) as caught:
        tracked(still([good, bad]), tmp_path, method)
    assert (caught.value.code, caught.value.frame) == ("results.droplets_not_finite", 1)


def test_parts_on_disk_do_not_outlive_the_work(method: str, tmp_path: Path) -> None:
    """Only the results stay, and the state that says it is done."""
    result = tracked(film(flow=vortices(8, 300), n_frames=6), tmp_path, method)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["trajectories.parquet", "rejected_trajectories.parquet", "events.parquet", "flow.zarr", "tracking"]
    )
    assert [path.name for path in (tmp_path / "tracking").iterdir()] == ["checkpoint.npz"]
    assert result.n_trajectories > 0
