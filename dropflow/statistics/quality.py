"""How well a run did, frame by frame: counts, matches, uncertainties, and how far predictions were off."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq
import zarr

from dropflow.experiment import Experiment
from dropflow.statistics.scope import Scope

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

MOST_COLUMNS = 2000
"""Of a longer film neighbouring frames are summed up by radius: twice what a screen shows."""

_COLUMNS = [
    *("trajectory_id", "frame", "time_s", "x_px", "y_px", "r_px", "r_std_px", "match", "is_detected"),
    *("u_um_s", "v_um_s", "sedimentation_um_s"),
]


@dataclass(frozen=True)
class _QualitySums:
    """Sums over the droplets of frames: sums of these are sums again, so that they coarsen."""

    time_s: Floats
    """Mean time of the frames, one a frame or column of frames."""
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


_SUMS = tuple(field.name for field in fields(_QualitySums) if field.name != "time_s")


@dataclass(frozen=True)
class FrameQuality(_QualitySums):
    """Over all radii, each of shape (n_frames,), or (n_columns,) where neighbouring frames are summed up."""


@dataclass(frozen=True)
class QualityByRadius(_QualitySums):
    """By radius, sums of shape (n_columns, n_bins); a column of a long film is a few neighbouring frames."""

    edges_um: Floats
    """Edges of the radius bins, shape (n_bins + 1,)."""
    first_frame: Integers
    """First frame of each column, shape (n_columns,)."""
    n_frames: Integers
    """Frames of each column, shape (n_columns,)."""

    def within(self, scope: Scope) -> FrameQuality:
        """The sums of each column over the bins whose middles lie inside the scope's radii."""
        bins = scope.bins(self.edges_um)
        return FrameQuality(self.time_s, **{name: getattr(self, name)[:, bins].sum(axis=1) for name in _SUMS})


def film_quality(
    folder: Path, times_s: Floats, experiment: Experiment, edges_um: Floats
) -> tuple[FrameQuality, QualityByRadius]:
    """What the tables of a film say of its frames, over all radii and by radius; one row group is in memory at a time.

    Parameters
    ----------
    folder
        Holds ``droplets.parquet``, ``trajectories.parquet`` and ``flow.zarr``.
    times_s
        Time of each frame, shape (n_frames,).
    edges_um
        Edges of the radius bins, shape (n_bins + 1,). Droplets outside them are in no bin.
    """
    n_frames, n_bins = len(times_s), len(edges_um) - 1
    n_together = max(1, -(-n_frames // MOST_COLUMNS))
    starts = np.arange(0, n_frames, n_together)
    every, by_radius = (_Sums(n) for n in (n_frames, len(starts) * n_bins))

    def add(name: str, frame: Integers, r_um: Floats, values: Floats | None = None) -> None:
        every.add(name, frame, values)
        radius_bin = np.searchsorted(edges_um, r_um, side="right") - 1
        inside = (radius_bin >= 0) & (radius_bin < n_bins)
        cell = frame // n_together * n_bins + radius_bin
        by_radius.add(name, cell[inside], None if values is None else values[inside])

    droplets = pq.ParquetFile(folder / "droplets.parquet")
    for group in range(droplets.num_row_groups):
        rows = droplets.read_row_group(group, columns=["frame", "r_um"])
        add("n_detected", _frames(rows), rows["r_um"].to_numpy())
    velocity = np.asarray(zarr.open_array(folder / "flow.zarr" / "velocity_um_s", mode="r")[:])
    grid = [
        np.asarray(zarr.open_array(folder / "flow.zarr" / name, mode="r")[:]) for name in ("grid_x_px", "grid_y_px")
    ]
    trajectories = pq.ParquetFile(folder / "trajectories.parquet")
    for group in range(trajectories.num_row_groups):
        rows = trajectories.read_row_group(group, columns=_COLUMNS)
        frame, r_um = _frames(rows), rows["r_px"].to_numpy() * experiment.pixel_size_um
        is_detected = rows["is_detected"].to_numpy(zero_copy_only=False)
        add("n_tracked", frame, r_um)
        add("n_predicted", frame[~is_detected], r_um[~is_detected])
        add("match_sum", frame, r_um, np.nan_to_num(np.where(is_detected, rows["match"].to_numpy(), 0.0)))
        std_share = rows["r_std_px"].to_numpy() / rows["r_px"].to_numpy()
        is_known = np.isfinite(std_share)
        add("radius_std_sum", frame[is_known], r_um[is_known], std_share[is_known])
        add("n_radius_std", frame[is_known], r_um[is_known])
        here, squared = _residuals(rows, velocity, grid, experiment)
        add("residual_squared_sum_px", frame[here], r_um[here], squared)
        add("n_residuals", frame[here], r_um[here])
    counted = np.diff(np.append(starts, n_frames))
    return FrameQuality(np.asarray(times_s, np.float64), **every.arrays()), QualityByRadius(
        edges_um=np.asarray(edges_um, np.float64),
        first_frame=starts,
        n_frames=counted,
        time_s=np.add.reduceat(np.asarray(times_s, np.float64), starts) / counted if n_frames else np.zeros(0),
        **by_radius.arrays((len(starts), n_bins)),
    )


class _Sums:
    """Sums by an index, those whose names begin with n_ of ones."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._sums = {name: np.zeros(size) for name in _SUMS}

    def add(self, name: str, index: Integers, values: Floats | None) -> None:
        self._sums[name] += np.bincount(index, values, self._size)

    def arrays(self, shape: tuple[int, ...] | None = None) -> dict[str, Any]:
        return {
            name: (sums.astype(np.int64) if name.startswith("n_") else sums).reshape(shape or sums.shape)
            for name, sums in self._sums.items()
        }


def _frames(rows: pa.Table) -> Integers:
    return np.asarray(rows["frame"].to_numpy(), np.int64)


def _residuals(
    rows: pa.Table, velocity: npt.NDArray[Any], grid: list[Floats], experiment: Experiment
) -> tuple[Integers, Floats]:
    """Rows of the droplets that go on to the next frame, and the squared distance (px) of each."""
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
    return here[is_known], squared[is_known]


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
