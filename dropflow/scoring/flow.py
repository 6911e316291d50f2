"""How well the flow field was measured."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import zarr
from scipy.interpolate import RegularGridInterpolator

from dropflow.errors import ResultsError
from dropflow.scoring.detection import share

Values = npt.NDArray[np.float64]


@dataclass(frozen=True)
class FlowSteps:
    """Flow fields of consecutive steps on one grid, as in ``flow.zarr``."""

    velocity_um_s: Values
    """Shape (step, 2, row, column)."""
    is_interpolated: npt.NDArray[np.bool_]
    """Shape (step, row, column)."""
    grid_x_px: Values
    grid_y_px: Values


@dataclass(frozen=True)
class FlowScore:
    """Flow fields against truth; errors and rms are of the velocity vector. None where there was nothing to count."""

    n_steps: int
    rms_um_s: float | None
    """Root mean square of the true velocity."""
    error_um_s: float | None
    """Root mean square of the difference, over all cells. A cell without a value counts as one of zero velocity."""
    error_over_rms: float | None
    error_over_fluctuation: float | None
    """The same error over the rms of the true velocity about its mean in space and time (without the drift)."""
    computed_error_over_rms: float | None
    """Error over rms, both over the cells alone that were computed from droplets."""
    computed_share: float | None
    """Share of the cells that were computed from droplets."""


def score_flow(found: FlowSteps, true: FlowSteps) -> FlowScore:
    """Compare flow fields step by step at the cells of `found`; the truth is interpolated to them where need be."""
    n_steps = min(len(found.velocity_um_s), len(true.velocity_um_s))
    truth = _on_grid_of(found, true, n_steps)
    error = np.nan_to_num(found.velocity_um_s[:n_steps]) - truth
    is_computed = ~found.is_interpolated[:n_steps]
    rms, error_rms = _rms(truth), _rms(error)
    mean = truth.mean(axis=(0, 2, 3), keepdims=True) if truth.size else 0.0
    by_cell = [np.moveaxis(values, 1, -1)[is_computed].T[None, :, :, None] for values in (error, truth)]
    return FlowScore(
        n_steps=n_steps,
        rms_um_s=rms,
        error_um_s=error_rms,
        error_over_rms=_ratio(error_rms, rms),
        error_over_fluctuation=_ratio(error_rms, _rms(truth - mean)),
        computed_error_over_rms=_ratio(*(_rms(values) for values in by_cell)),
        computed_share=float(is_computed.mean()) if is_computed.size else None,
    )


def read_flow(path: Path) -> FlowSteps:
    """Read ``flow.zarr`` or ``truth_flow.zarr``."""
    try:
        store = zarr.open_group(path, mode="r")
        arrays: list[Any] = [store[name] for name in FlowSteps.__dataclass_fields__]
        return FlowSteps(*(array[...] for array in arrays))
    except (OSError, KeyError, ValueError, TypeError) as problem:
        raise ResultsError(f"This is no flow field ({problem}).", code="results.unreadable", file=str(path)) from None


def _on_grid_of(found: FlowSteps, true: FlowSteps, n_steps: int) -> Values:
    values = true.velocity_um_s[:n_steps].astype(np.float64)
    is_same = np.array_equal(found.grid_x_px, true.grid_x_px) and np.array_equal(found.grid_y_px, true.grid_y_px)
    if is_same or n_steps == 0:
        return values
    rows, columns = np.meshgrid(found.grid_y_px, found.grid_x_px, indexing="ij")
    interpolate = RegularGridInterpolator(
        (true.grid_y_px, true.grid_x_px), np.moveaxis(values, (2, 3), (0, 1)), bounds_error=False, fill_value=None
    )
    return np.moveaxis(interpolate(np.stack([rows, columns], axis=-1)), (0, 1), (2, 3))


def _rms(velocity: Values) -> float | None:
    """Root of the mean square of the vector along axis 1."""
    return float(np.sqrt(np.mean(np.sum(velocity**2, axis=1)))) if velocity.size else None


def _ratio(part: float | None, whole: float | None) -> float | None:
    return None if part is None or whole is None else share(part, whole)
