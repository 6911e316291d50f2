"""How well a run did, frame by frame: counts, matches, uncertainties, and how far predictions were off."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq
import zarr

from dropflow.experiment import Experiment

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

_COLUMNS = [
    *("trajectory_id", "frame", "time_s", "x_px", "y_px", "r_px", "r_std_px", "match", "is_detected"),
    *("u_um_s", "v_um_s", "sedimentation_um_s"),
]


@dataclass(frozen=True)
class FrameQuality:
    """Sums over the droplets of each frame, shape (n_frames,): sums of frames are sums again, so that they coarsen."""

    time_s: Floats
    n_detected: Integers
    """Droplets that detection found."""
    n_tracked: Integers
    """Droplets on trajectories."""
    n_predicted: Integers
    """Of these, found by prediction."""
    match_sum: Floats
    """Over the tracked droplets that detection found."""
    radius_std_sum: Floats
    """Relative standard deviation of the radius, over the tracked droplets that have one."""
    n_radius_std: Integers
    residual_squared_sum_px: Floats
    """Squared distance between where flow and sedimentation take a droplet and where it is in the next frame."""
    n_residuals: Integers


def frame_quality(folder: Path, times_s: Floats, experiment: Experiment) -> FrameQuality:
    """What the tables of a film say of each of its frames; one row group is in memory at a time.

    Parameters
    ----------
    folder
        Holds ``droplets.parquet``, ``trajectories.parquet`` and ``flow.zarr``.
    times_s
        Time of each frame, shape (n_frames,).
    """
    n_frames = len(times_s)
    sums = np.zeros((4, n_frames))
    n_detected, counts = np.zeros(n_frames, np.int64), np.zeros((3, n_frames), np.int64)
    droplets = pq.ParquetFile(folder / "droplets.parquet")
    for group in range(droplets.num_row_groups):
        frames = droplets.read_row_group(group, columns=["frame"])["frame"].to_numpy()
        n_detected += np.bincount(frames, minlength=n_frames)
    velocity = np.asarray(zarr.open_array(folder / "flow.zarr" / "velocity_um_s", mode="r")[:])
    grid = [
        np.asarray(zarr.open_array(folder / "flow.zarr" / name, mode="r")[:]) for name in ("grid_x_px", "grid_y_px")
    ]
    trajectories = pq.ParquetFile(folder / "trajectories.parquet")
    for group in range(trajectories.num_row_groups):
        rows = trajectories.read_row_group(group, columns=_COLUMNS)
        frame, values = _by_droplet(rows)
        for index, value in enumerate(values):
            sums[index] += np.bincount(frame, np.nan_to_num(value), n_frames)
        counts[0] += np.bincount(frame, minlength=n_frames)
        counts[1] += np.bincount(frame[np.isfinite(values[2])], minlength=n_frames)
        steps, squared = _residuals(rows, velocity, grid, experiment)
        sums[3] += np.bincount(steps, squared, n_frames)
        counts[2] += np.bincount(steps, minlength=n_frames)
    return FrameQuality(
        time_s=np.asarray(times_s, np.float64),
        n_detected=n_detected,
        n_tracked=counts[0],
        n_predicted=sums[0].astype(np.int64),
        match_sum=sums[1],
        radius_std_sum=sums[2],
        n_radius_std=counts[1],
        residual_squared_sum_px=sums[3],
        n_residuals=counts[2],
    )


def _by_droplet(rows: pa.Table) -> tuple[Integers, tuple[Floats, Floats, Floats]]:
    """Frame of each row, and what is summed: whether it was predicted, its match, its relative uncertainty."""
    is_detected = rows["is_detected"].to_numpy(zero_copy_only=False)
    match = np.where(is_detected, rows["match"].to_numpy(), 0.0)
    r_px, r_std_px = rows["r_px"].to_numpy(), rows["r_std_px"].to_numpy()
    return rows["frame"].to_numpy().astype(np.int64), ((~is_detected).astype(np.float64), match, r_std_px / r_px)


def _residuals(
    rows: pa.Table, velocity: npt.NDArray[Any], grid: list[Floats], experiment: Experiment
) -> tuple[Integers, Floats]:
    """Step and squared distance (px) of each droplet that goes on to the next frame."""
    column = {name: rows[name].to_numpy(zero_copy_only=False) for name in rows.column_names}
    goes_on = (np.diff(column["trajectory_id"]) == 0) & (np.diff(column["frame"]) == 1)
    here = np.flatnonzero(goes_on)
    step_s = column["time_s"][here + 1] - column["time_s"][here]
    flow = flow_at(velocity, grid, column["frame"][here], column["x_px"][here], column["y_px"][here])
    sinking = column["sedimentation_um_s"][here]
    off_x = column["u_um_s"][here] - flow[0] - sinking * experiment.up[0]
    off_y = column["v_um_s"][here] - flow[1] - sinking * experiment.up[1]
    squared = (off_x**2 + off_y**2) * (step_s / experiment.pixel_size_um) ** 2
    is_known = np.isfinite(squared)
    return column["frame"][here][is_known].astype(np.int64), squared[is_known]


def flow_at(
    velocity: npt.NDArray[Any], grid: list[Floats], step: Any, x_px: Floats, y_px: Floats
) -> tuple[Floats, Floats]:
    """Both components of the flow at places of steps, linear between the centres of the cells."""
    places = []
    for centres, place in zip(grid, (x_px, y_px), strict=True):
        at = np.clip(np.interp(place, centres, np.arange(len(centres))), 0, len(centres) - 1)
        low = np.minimum(at.astype(np.int64), max(len(centres) - 2, 0))
        places.append((low, np.minimum(low + 1, len(centres) - 1), at - low))
    (left, right, across), (top, bottom, down) = places
    found = []
    for component in (0, 1):
        field = velocity[:, component]
        upper = field[step, top, left] * (1 - across) + field[step, top, right] * across
        lower = field[step, bottom, left] * (1 - across) + field[step, bottom, right] * across
        found.append(np.asarray(upper * (1 - down) + lower * down, np.float64))
    return found[0], found[1]
