"""Mean and root mean square of the flow over time (section 4.6)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import zarr

from dropflow.errors import ResultsError

Floats = npt.NDArray[np.float64]

_STEPS_AT_ONCE = 256


@dataclass(frozen=True)
class FlowMoments:
    """Moments over the cells of each step that were computed from droplets; NaN where there is no such cell."""

    time_s: Floats
    """When the step begins, shape (n,)."""
    mean_um_s: Floats
    """Shape (n, 2): horizontal, upward."""
    rms_um_s: Floats
    """Shape (n, 2): horizontal, upward."""


def flow_moments(flow: Path, up: tuple[float, float]) -> FlowMoments:
    """Mean and rms of the horizontal and the upward flow of each step of a film (Fig. 14).

    Parameters
    ----------
    flow
        The folder ``flow.zarr``; some steps are in memory at a time.
    up
        Unit vector against gravity in image axes. Horizontal is to the right of it: along x where up is (0, -1).

    Raises
    ------
    ResultsError
        The folder cannot be read.
    """
    try:
        velocities, interpolated, times = (
            zarr.open_array(flow / name, mode="r") for name in ("velocity_um_s", "is_interpolated", "time_s")
        )
    except (FileNotFoundError, ValueError) as problem:
        raise ResultsError(f"The flow field cannot be read ({problem}).", file=str(flow)) from None
    n_steps = velocities.shape[0]
    moments = [np.empty((0, 2, 2))]
    for start in range(0, n_steps, _STEPS_AT_ONCE):
        steps = slice(start, start + _STEPS_AT_ONCE)
        velocity = _turned(np.asarray(velocities[steps], np.float64), up)
        moments.append(_moments(velocity, ~np.asarray(interpolated[steps])))
    mean, rms = np.concatenate(moments).transpose(1, 0, 2)
    return FlowMoments(np.asarray(times[:], np.float64), mean, rms)


def coarsen_flow(moments: FlowMoments, most: int) -> FlowMoments:
    """Mean and rms over neighbouring steps together, so that at most `most` remain; steps without flow do not count."""
    n_together = -(-len(moments.time_s) // most)
    if n_together <= 1:
        return moments
    starts = np.arange(0, len(moments.time_s), n_together)
    known = np.isfinite(moments.mean_um_s[:, :1])
    n_known = np.add.reduceat(known, starts, axis=0, dtype=np.int64)

    def mean(values: Floats) -> Floats:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.add.reduceat(np.where(known, values, 0.0), starts, axis=0) / n_known)

    n_steps = np.diff(np.append(starts, len(moments.time_s)))
    time_s = np.add.reduceat(moments.time_s, starts) / n_steps
    return FlowMoments(time_s, mean(moments.mean_um_s), np.sqrt(mean(moments.rms_um_s**2)))


def _turned(velocity: Floats, up: tuple[float, float]) -> Floats:
    """Components along x and y (axis 1) as horizontal and upward ones."""
    axes = np.array([[-up[1], up[0]], [up[0], up[1]]])
    return np.asarray(np.einsum("ij,njrc->nirc", axes, velocity))


def _moments(velocity: Floats, is_computed: npt.NDArray[np.bool_]) -> Floats:
    """Mean and rms of each step, shape (n, 2 moments, 2 components)."""
    n_cells = is_computed.sum(axis=(1, 2))[:, None]
    counted = np.where(is_computed[:, None], velocity, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = counted.sum(axis=(2, 3)) / n_cells
        rms = np.sqrt((counted**2).sum(axis=(2, 3)) / n_cells)
    return np.stack([mean, rms], axis=1)
