"""Vertical velocity against radius, and what Stokes and the mean flow make of it (section 4.1, Fig. 9)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.statistics.binned import BinnedMean, binned_mean
from dropflow.statistics.bootstrap import bootstrap_std

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class VelocityByRadius:
    """Measured and expected velocity along up, in bins of radius."""

    measured: BinnedMean
    """Mean over trajectories of the velocity along up, um/s."""
    radius_std_um: Floats
    """Mean scatter of the radius within trajectories, shape (n_bins,): the horizontal error bar."""
    expected_um_s: Floats
    """Stokes velocity at the bin's mean r^2 plus the mean flow, shape (n_bins,)."""
    flow_um_s: float
    """Mean upward flow that was added."""


def velocity_by_radius(
    trajectories: pl.DataFrame, edges_um: Floats, *, mean_upward_flow_um_s: float = 0.0
) -> VelocityByRadius:
    """Mean velocity along up of the trajectories in each radius bin, beside Stokes' law with the mean flow.

    Parameters
    ----------
    trajectories
        One row a trajectory (`summarise_trajectories`).
    edges_um
        Edges of the radius bins.
    mean_upward_flow_um_s
        Mean vertical flow of the same time, from the flow field's computed cells.

    Notes
    -----
    The errors take trajectories as independent. Neighbours share the same flow: in a film shorter than several
    correlation times they are too small.
    """
    radius = trajectories["r_mean_um"].to_numpy()
    measured = binned_mean(radius, trajectories["rise_um_s"].to_numpy(), edges_um)
    scatter = binned_mean(radius, trajectories["r_std_um"].fill_null(np.nan).to_numpy(), edges_um)
    stokes = binned_mean(radius, trajectories["sedimentation_um_s"].to_numpy(), edges_um)
    expected = stokes.mean + mean_upward_flow_um_s
    return VelocityByRadius(measured, scatter.mean, expected, mean_upward_flow_um_s)


@dataclass(frozen=True)
class RadiusScatter:
    """Scatter of the radius within trajectories, against radius (section 4.4)."""

    scatter: BinnedMean
    """Mean standard deviation, um."""
    relative: float
    """Slope of the straight part through the origin: the relative uncertainty of small droplets."""
    plateau_um: float
    """Constant value beyond it."""
    break_um: float
    """Radius at which the one goes over into the other."""
    relative_std: float
    """Standard error of `relative`, by bootstrap over trajectories."""


def radius_scatter(trajectories: pl.DataFrame, edges_um: Floats, *, least_frames: int = 4) -> RadiusScatter:
    """Mean standard deviation of the radius in trajectories of `least_frames` at least, and the paper's two pieces.

    The scatter is taken about each trajectory's own straight line in time, so that growth is not taken for noise.
    """
    long = trajectories.filter(pl.col("n_frames") >= least_frames)
    radius, std = long["r_mean_um"].to_numpy(), long["r_std_um"].fill_null(np.nan).to_numpy()
    scatter = binned_mean(radius, std, edges_um)
    which = np.clip(np.searchsorted(edges_um, radius, side="right") - 1, 0, len(edges_um) - 2)
    used = np.flatnonzero(np.isfinite(std) & (radius >= edges_um[0]) & (radius < edges_um[-1]))

    def relative(entries: npt.NDArray[np.int64], weight: Floats) -> float:
        bins, values = which[used[entries]], std[used[entries]]
        n = np.asarray(np.bincount(bins, weight, len(edges_um) - 1), np.float64)
        with np.errstate(invalid="ignore", divide="ignore"):
            return _two_pieces(scatter.x, np.bincount(bins, weight * values, len(n)) / n, n)[0]

    return RadiusScatter(
        scatter, *_two_pieces(scatter.x, scatter.mean, scatter.n.astype(np.float64)), bootstrap_std(relative, len(used))
    )


def _two_pieces(radius_um: Floats, mean_um: Floats, n: Floats) -> tuple[float, float, float]:
    """Least-squares slope through the origin up to the best break, and the constant that it reaches there."""
    is_known = np.isfinite(mean_um)
    x, y, weight = radius_um[is_known], mean_um[is_known], n[is_known]
    best = (np.inf, np.nan, np.nan, np.nan)
    for break_um in x:
        bent = np.minimum(x, break_um)
        slope = float((weight * bent * y).sum() / (weight * bent**2).sum())
        misfit = float((weight * (y - slope * bent) ** 2).sum())
        if misfit < best[0]:
            best = (misfit, slope, slope * float(break_um), float(break_um))
    return best[1:]
