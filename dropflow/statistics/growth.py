"""Growth of single droplets and the collision efficiency that follows from it (section 5)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.physics.stokes import sedimentation_um_s
from dropflow.statistics.binned import BinnedMean, binned_mean

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Growth:
    """dr/dt against radius."""

    rate: BinnedMean
    """Mean over trajectories, um/s, weighted by their own uncertainty."""


def growth_by_radius(trajectories: pl.DataFrame, edges_um: Floats, *, least_frames: int = 6) -> Growth:
    """Weighted mean of dr/dt over the trajectories in each radius bin.

    The weight of a trajectory is what its length is worth: a slope's variance falls as the third power of the time, so
    short trajectories count little. The standard error comes from the scatter between trajectories.
    """
    long = trajectories.filter((pl.col("n_frames") >= least_frames) & pl.col("growth_um_s").is_not_null())
    radius, slope = long["r_mean_um"].to_numpy(), long["growth_um_s"].to_numpy()
    duration_s = (long["end_s"] - long["start_s"]).to_numpy()
    return Growth(_weighted(radius, slope, duration_s**2 * long["n_frames"].to_numpy(), edges_um))


def _weighted(x: Floats, y: Floats, weight: Floats, edges: Floats) -> BinnedMean:
    plain = binned_mean(x, y, edges)
    n_bins = len(edges) - 1
    which = np.searchsorted(edges, x, side="right") - 1
    inside = (which >= 0) & (which < n_bins) & (x < edges[-1])
    which, y, weight = which[inside], y[inside], weight[inside]
    with np.errstate(invalid="ignore", divide="ignore"):
        total = np.bincount(which, weight, n_bins)
        mean = np.bincount(which, weight * y, n_bins) / total
        pull = (weight * (y - mean[which])) ** 2
        error = np.sqrt(np.bincount(which, pull, n_bins)) / total * np.sqrt(plain.n / np.maximum(plain.n - 1, 1))
    return BinnedMean(edges, plain.x, mean, plain.std, np.where(plain.n > 1, error, np.nan), plain.n)


def swept_growth_um_s(
    r_um: Floats, bin_radius_um: Floats, number_per_um3: Floats, *, delta_density_kg_m3: float, viscosity_pa_s: float
) -> Floats:
    """Growth dr/dt of droplets that take up every smaller one in their way: collision efficiency 1.

    In time dt a droplet of radius r sweeps pi (r + s)^2 (u(r) - u(s)) dt of fluid that holds n(s) droplets of radius
    s, and gains their volume: dr/dt = pi / 3 sum_s (r + s)^2 (u(r) - u(s)) s^3 n(s) / r^2.

    Parameters
    ----------
    r_um
        Radii asked for, shape (n,).
    bin_radius_um, number_per_um3
        Droplets per volume in each radius bin (not per radius), shape (n_bins,).
    """
    stokes = {"delta_density_kg_m3": delta_density_kg_m3, "viscosity_pa_s": viscosity_pa_s}
    faster = np.abs(sedimentation_um_s(r_um, **stokes))[:, None] - np.abs(sedimentation_um_s(bin_radius_um, **stokes))
    swept = (r_um[:, None] + bin_radius_um) ** 2 * np.maximum(faster, 0)
    return np.asarray((swept * bin_radius_um**3 * number_per_um3).sum(axis=1) * (np.pi / 3) / r_um**2)


def collision_efficiency(growth: Growth, swept_um_s: Floats) -> tuple[Floats, Floats]:
    """Measured over swept growth in each radius bin, and its standard error; NaN where nothing is swept.

    It is an upper bound: growth by diffusion from the supersaturated fluid counts as collisions, too.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(swept_um_s > 0, growth.rate.mean / swept_um_s, np.nan)
        error = np.where(swept_um_s > 0, growth.rate.standard_error / swept_um_s, np.nan)
    return share, error
