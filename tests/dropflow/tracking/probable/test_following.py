"""What tracking by probability does over a film, beyond what holds for every method."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest
import zarr

from dropflow.experiment import FixedMaterial
from tests.dropflow.tracking.generated import Film, film, vortices
from tests.dropflow.tracking.tracked import link_scores, read, tracked


def flow_error(given: Film, folder: Path, true: object) -> float:
    """Error over rms of the stored flow, in the middle of each step."""
    store = zarr.open_group(folder / "flow.zarr", mode="r")
    x, y = (places.ravel() for places in np.meshgrid(store["grid_x_px"][:], store["grid_y_px"][:]))
    velocity = store["velocity_um_s"][:]
    middle = (given.times_s[1:] + given.times_s[:-1]) / 2
    expected = np.stack([true(x, y, time) for time in middle]) * given.experiment.pixel_size_um  # type: ignore[operator]
    error = velocity.reshape(expected.shape) - expected
    return float(np.sqrt((error**2).mean() / (expected**2).mean()))


def test_the_flow_is_measured_several_times_better_than_by_the_papers_average(tmp_path: Path) -> None:
    """On the same detections."""
    true = vortices(12, 300)
    given = film(flow=true, n_droplets=250, n_frames=8, radius_error=0.03)
    errors = {}
    for method in ("default", "paper"):
        tracked(given, tmp_path / method, method)
        errors[method] = flow_error(given, tmp_path / method, true)
    assert errors["default"] < 0.15
    assert errors["default"] < 0.4 * errors["paper"]


def test_a_droplet_missed_in_one_frame_stays_one_trajectory(tmp_path: Path) -> None:
    """The row between says that it was not detected, and is where the droplet was."""
    given = film(flow=vortices(10, 300), n_frames=8)
    hole = given.frames[4]
    middle = np.hypot(hole.x_px - 306, hole.y_px - 256) < 150
    missing = given.truth[4][middle]
    cut = replace(given, frames=[*given.frames[:4], hole[~middle], *given.frames[5:]])
    rows = read(tracked(cut, tmp_path)).filter(pc.field("frame") == 4)
    unseen = rows.filter(~pc.field("is_detected"))
    assert len(missing) > 10
    assert len(unseen) >= 0.8 * len(missing)
    places = np.column_stack([hole.x_px[middle], hole.y_px[middle]])
    found = np.column_stack([unseen["x_px"].to_numpy(), unseen["y_px"].to_numpy()])
    assert np.median(np.linalg.norm(found[:, None] - places, axis=2).min(axis=1)) < 1.0


def test_trajectories_do_not_end_in_rows_that_nothing_shows(tmp_path: Path) -> None:
    """A droplet is waited for, but if it does not come back it left when it was last seen."""
    given = film(flow=vortices(10, 300), n_frames=8)
    cut = replace(given, frames=[*given.frames[:5], given.frames[5][:0], *given.frames[6:7], given.frames[7][:0]])
    rows = read(tracked(cut, tmp_path))
    assert len(rows.filter(pc.field("frame") == 7)) == 0
    assert len(rows.filter(pc.field("frame") == 5)) > 0


@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_a_material_that_is_wrong_by_a_third_costs_nothing(factor: float, tmp_path: Path) -> None:
    """The droplets themselves show how fast they sediment."""
    given = film(flow=vortices(10, 300), n_frames=8, n_droplets=250)
    material = given.experiment.material
    assert isinstance(material, FixedMaterial)
    wrong = material.model_copy(update={"delta_density_kg_m3": factor * material.delta_density_kg_m3})
    mistaken = replace(given, experiment=given.experiment.model_copy(update={"material": wrong}))
    right = link_scores(given, read(tracked(given, tmp_path / "right")))
    result = tracked(mistaken, tmp_path / "wrong")
    precision, recall = link_scores(mistaken, read(result))
    assert precision > 0.99
    assert recall > right[1] - 0.02


def test_droplets_may_travel_as_far_as_their_spacing(tmp_path: Path) -> None:
    """From the first frame on, though nothing is known of the flow."""
    given = film(flow=vortices(35, 400, drift_px_s=(25, 0)), n_frames=6, n_droplets=250, radius_error=0.02)
    spacing_px = np.sqrt(512 * 612 / np.mean([len(droplets) for droplets in given.frames]))
    precision, recall = link_scores(given, read(tracked(given, tmp_path)))
    assert spacing_px < 45
    assert precision > 0.97
    assert recall > 0.85


def test_a_camera_that_is_pushed_loses_no_droplet(tmp_path: Path) -> None:
    """All places jump by more than the spacing between two frames."""
    given = film(flow=vortices(6, 300), n_frames=10, n_droplets=250, radius_error=0.02)
    pushed = [
        droplets if frame < 5 else replace(droplets, x_px=droplets.x_px + 55.0)
        for frame, droplets in enumerate(given.frames)
    ]
    moved = replace(given, frames=pushed)
    result = tracked(moved, tmp_path)
    precision, recall = link_scores(moved, read(result))
    assert precision > 0.98
    assert recall > 0.9
    (shift,) = (row for row in pq.read_table(result.events).to_pylist() if row["kind"] == "shift")
    assert (shift["frame"], shift["cause"], shift["trajectory_id"]) == (5, "camera", None)
    assert (shift["x_px"], shift["y_px"]) == pytest.approx((-55, 0), abs=3)


def test_a_push_of_the_camera_is_in_no_velocity(tmp_path: Path) -> None:
    """Places are those of the image; velocities, flow and drift are those of the fluid."""
    given = film(flow=vortices(8, 300, drift_px_s=(6, 0)), n_frames=14)
    push = np.array([25.0, -10.0])
    frames = [
        replace(droplets, x_px=droplets.x_px + push[0], y_px=droplets.y_px + push[1]) if frame >= 7 else droplets
        for frame, droplets in enumerate(given.frames)
    ]
    still = tracked(given, tmp_path / "still", "default")
    pushed = tracked(replace(given, frames=frames), tmp_path / "pushed", "default")
    pixel = given.experiment.pixel_size_um
    speeds = {}
    for name, result in (("still", still), ("pushed", pushed)):
        rows = read(result).filter(pc.field("frame") == 6)
        flow = zarr.open_group(result.flow, mode="r")["velocity_um_s"][6]
        u, v = (float(np.median(rows[column].to_numpy())) for column in ("u_um_s", "v_um_s"))
        speeds[name] = np.array([u, v, *flow.mean(axis=(1, 2)), *result.drift_um_s]) / pixel
    np.testing.assert_allclose(speeds["pushed"], speeds["still"], atol=1.5)


def test_a_camera_at_rest_is_not_said_to_have_moved(tmp_path: Path) -> None:
    """However the flow turns."""
    given = film(flow=vortices(10, 300, drift_px_s=(10, 5)), n_frames=10, n_droplets=60, radius_error=0.02)
    assert "shift" not in pq.read_table(tracked(given, tmp_path).events)["kind"].to_pylist()


@pytest.mark.parametrize("n_false", [20, 120])
def test_false_detections_alone_make_no_trajectories(n_false: int, tmp_path: Path) -> None:
    """At most one in a hundred; the others are rejected for a reason."""
    given = film(flow=vortices(0, 300), n_frames=25, n_droplets=0, n_false=n_false)
    result = tracked(given, tmp_path)
    n_rows = len(read(result))
    assert n_rows <= 0.01 * 25 * n_false
    n_rejected = pc.sum(pq.read_table(result.rejected)["n_detected"]).as_py()
    assert n_rejected >= 0.99 * 25 * n_false
