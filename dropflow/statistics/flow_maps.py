"""The flow over the field of view: means over a range of time, and what turns and what swells."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Steps = tuple[npt.NDArray[Any], npt.NDArray[np.bool_]]
"""Velocities of some steps, shape (n, 2, rows, columns), um/s, and whether each cell was interpolated."""


@dataclass(frozen=True)
class FlowMap:
    """The flow at each place, averaged over the steps in which the cell was computed from droplets.

    Each of shape (rows, columns); NaN where it never was.
    """

    u_um_s: Floats
    """Mean along x."""
    v_um_s: Floats
    """Mean along y (downwards)."""
    rms_um_s: Floats
    """Root of the mean squared speed."""
    computed_share: Floats
    """Share of the steps in which the cell was computed from droplets."""


def flow_map(steps: Iterable[Steps], *, is_every_cell_taken: bool = False) -> FlowMap:
    """Mean and rms of the flow in each cell.

    Parameters
    ----------
    steps
        Pieces of the film, one after the other.
    is_every_cell_taken
        Also take interpolated values, as for a single step.
    """
    sums: list[Any] = [0.0, 0.0, 0.0]
    n_taken: Any = 0
    n_computed: Any = 0
    n_steps = 0
    for velocity, is_interpolated in steps:
        known = np.isfinite(velocity).all(axis=1)
        is_computed = known & ~is_interpolated
        is_taken = known if is_every_cell_taken else is_computed
        u, v = (np.where(is_taken, velocity[:, axis], 0.0).astype(np.float64) for axis in (0, 1))
        for index, values in enumerate((u, v, u**2 + v**2)):
            sums[index] = sums[index] + values.sum(axis=0)
        n_taken = n_taken + is_taken.sum(axis=0)
        n_computed = n_computed + is_computed.sum(axis=0)
        n_steps += len(velocity)
    with np.errstate(invalid="ignore", divide="ignore"):
        u, v, squared = (np.asarray(total / n_taken, np.float64) for total in sums)
    return FlowMap(u, v, np.sqrt(squared), np.asarray(n_computed / max(n_steps, 1), np.float64))


def vorticity_per_s(u_um_s: Floats, v_um_s: Floats, x_um: Floats, y_um: Floats) -> Floats:
    """How fast the fluid turns, 1/s: positive anticlockwise as the frame is seen (y points down there).

    Parameters
    ----------
    u_um_s, v_um_s
        Velocity along x and y, shape (rows, columns).
    x_um, y_um
        Centres of columns and rows, ascending.
    """
    return np.asarray(np.gradient(u_um_s, y_um, axis=0) - np.gradient(v_um_s, x_um, axis=1))


def divergence_per_s(u_um_s: Floats, v_um_s: Floats, x_um: Floats, y_um: Floats) -> Floats:
    """How fast fluid seems to come from outside the sheet of light, 1/s; parameters as of `vorticity_per_s`."""
    return np.asarray(np.gradient(u_um_s, x_um, axis=1) + np.gradient(v_um_s, y_um, axis=0))
