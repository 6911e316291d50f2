"""Steps in which the camera moved: all droplets at once go elsewhere than before and after."""

import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import zarr

from dropflow.tracking.flow_store import STEPS_PER_CHUNK
from dropflow.tracking.grid import Column

_N_BESIDE = 3
"""Steps before and after with which a step is compared."""
_LEAST_STEPS = 5
_MOST_DEVIATION = 8.0
"""Of the mean flow from that of the steps beside, in units of what is usual in the film."""
_LEAST_SHIFT_PX = 2.0
_NORMAL_MAD = 1.4826
"""Standard deviation of a normal variable over its median absolute deviation."""


def camera_shifts_px(velocity_um_s: Column, dt_s: Column, pixel_size_um: float) -> Column:
    """By how much the camera moved in each step, shape (n_steps, 2), px; zero where it did not.

    A flow changes from step to step by little and goes on changing; a push is in one step alone.

    Parameters
    ----------
    velocity_um_s : ndarray, float64, shape (n_steps, 2)
        Mean of the flow field of each step along x and y; NaN where it is not known.
    dt_s : ndarray, float64, shape (n_steps,)
    pixel_size_um : float
    """
    n_steps = len(velocity_um_s)
    shifts = np.zeros((n_steps, 2))
    if n_steps < _LEAST_STEPS:
        return shifts
    expected = np.full((n_steps, 2), np.nan)
    for step in range(n_steps):
        beside = np.delete(
            np.arange(max(step - _N_BESIDE, 0), min(step + _N_BESIDE + 1, n_steps)), min(step, _N_BESIDE)
        )
        known = velocity_um_s[beside][np.isfinite(velocity_um_s[beside, 0])]
        if len(known) > 1:
            expected[step] = np.median(known, axis=0)
    off_px = (velocity_um_s - expected) * dt_s[:, None] / pixel_size_um
    is_known = np.isfinite(off_px).all(axis=1)
    if not is_known.any():
        return shifts
    usual_px = _NORMAL_MAD * float(np.median(np.abs(off_px[is_known])))
    away_px = np.hypot(*np.nan_to_num(off_px).T)
    has_moved = is_known & (away_px > _LEAST_SHIFT_PX + _MOST_DEVIATION * usual_px)
    shifts[has_moved] = off_px[has_moved]
    return shifts


def shifts_of_flow_px(flow: Path, times_s: Column, pixel_size_um: float) -> Column:
    """By how much the camera moved in each step of a flow store, which is read a few steps at a time."""
    if len(times_s) < 2:
        return np.zeros((0, 2))
    velocity_um_s = zarr.open_array(flow / "velocity_um_s", mode="r")
    parts = [
        np.asarray(velocity_um_s[first : first + STEPS_PER_CHUNK], np.float64).mean(axis=(2, 3))
        for first in range(0, len(times_s) - 1, STEPS_PER_CHUNK)
    ]
    return camera_shifts_px(np.concatenate(parts), np.diff(times_s), pixel_size_um)


def steadied_flow(flow: Path, steadied: Path, push_um_s: Column) -> None:
    """Copy a flow store, less the velocity (n_steps, 2) that a push of the camera gave to all droplets of a step."""
    shutil.rmtree(steadied, ignore_errors=True)
    shutil.copytree(flow, steadied)
    velocity_um_s = zarr.open_array(steadied / "velocity_um_s", mode="r+")
    for step in np.flatnonzero(push_um_s.any(axis=1)).tolist():
        velocity_um_s[step] = np.asarray(velocity_um_s[step]) - push_um_s[step].astype(np.float32)[:, None, None]


def steadied_rows(rows: pa.Table, push_um_s: Column) -> pa.Table:
    """Rows of whole trajectories, sorted, with velocities less the push of the camera in their step."""
    if not push_um_s.any() or not len(rows):
        return rows
    ids, frames = rows["trajectory_id"].to_numpy(), rows["frame"].to_numpy()
    step = frames - np.append(np.diff(ids) != 0, True)  # the last row has the velocity of the step before it
    for axis, name in enumerate(("u_um_s", "v_um_s")):
        index = rows.schema.get_field_index(name)
        steady = rows[name].to_numpy() - push_um_s[np.maximum(step, 0), axis]
        rows = rows.set_column(index, rows.schema.field(name), pa.array(steady))
    return rows
