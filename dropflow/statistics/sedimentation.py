"""Vertical velocity against radius, and what Stokes and the mean flow make of it (section 4.1, Fig. 9)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.statistics.binned import BinnedMean, binned_mean

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


def radius_scatter(trajectories: pl.DataFrame, edges_um: Floats, *, least_frames: int = 4) -> RadiusScatter:
    """Mean standard deviation of the radius in trajectories of `least_frames` at least, and the paper's two pieces.

    The scatter is taken about each trajectory's own straight line in time, so that growth is not taken for noise.
    """
    long = trajectories.filter(pl.col("n_frames") >= least_frames)
    scatter = binned_mean(long["r_mean_um"].to_numpy(), long["r_std_um"].fill_null(np.nan).to_numpy(), edges_um)
    return RadiusScatter(scatter, *_two_pieces(scatter))


def _two_pieces(scatter: BinnedMean) -> tuple[float, float, float]:
    """Least-squares slope through the origin up to the best break, and the constant that it reaches there."""
    is_known = np.isfinite(scatter.mean)
    x, y, weight = scatter.x[is_known], scatter.mean[is_known], scatter.n[is_known].astype(np.float64)
    best = (np.inf, np.nan, np.nan, np.nan)
    for break_um in x:
        bent = np.minimum(x, break_um)
        slope = float((weight * bent * y).sum() / (weight * bent**2).sum())
        misfit = float((weight * (y - slope * bent) ** 2).sum())
        if misfit < best[0]:
            best = (misfit, slope, slope * float(break_um), float(break_um))
    return best[1:]
