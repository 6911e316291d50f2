"""The size distribution n(r, t) and its moments, from histograms, with uncertainty (sections 4.5, 4.3).

Counts of different droplets follow Poisson's law. A droplet that stays in sight is counted again in every frame: with
`InSight` the uncertainty is that of drawing whole trajectories again.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from dropflow.statistics.histograms import FrameHistograms
from dropflow.statistics.in_sight import InSight

Floats = npt.NDArray[np.float64]

DensityUnit = Literal["um^-4", "um^-3"]

PERCENTILES = (10.0, 50.0, 90.0)


@dataclass(frozen=True)
class SizeDistribution:
    """Droplets per volume (um^-4) or, where the observed depth is unknown, per area (um^-3) and per radius."""

    density: Floats
    """n(r, t), shape (n_columns, n_bins); 0 where no droplet was seen."""
    density_std: Floats
    """Its standard deviation, shape (n_columns, n_bins)."""
    unit: DensityUnit


def size_distribution(
    histograms: FrameHistograms,
    *,
    area_um2: float,
    observation_depth_um: float | Floats | None = None,
    seen: InSight | None = None,
) -> SizeDistribution:
    """Droplet number density per radius: counts over frames, area, depth and width of the bin.

    Parameters
    ----------
    histograms
        Counted droplets.
    area_um2
        Area of the sample that one frame shows.
    observation_depth_um
        Depth over which droplets are seen: one number, or one for each radius bin, shape (n_bins,).
        None gives the density per area.
    seen
        How long droplets stay in sight, in the same radius bins; without it each count is taken for another droplet.
    """
    depth_um = 1.0 if observation_depth_um is None else observation_depth_um
    observed = histograms.n_frames[:, None] * area_um2 * np.diff(histograms.edges_um) * depth_um
    return SizeDistribution(
        density=histograms.counts / observed,
        density_std=np.sqrt(histograms.counts * _variance_factor(histograms, seen)) / observed,
        unit="um^-3" if observation_depth_um is None else "um^-4",
    )


def _variance_factor(histograms: FrameHistograms, seen: InSight | None) -> Floats:
    """Variance of each count over Poisson's, shape (n_columns, n_bins)."""
    return np.ones(histograms.counts.shape) if seen is None else seen.variance_factor(histograms.n_frames)


@dataclass(frozen=True)
class SizeMoments:
    """Moments over time, each of shape (n_columns,); NaN where a column holds no droplet and there is no such value."""

    n_per_frame: Floats
    n_per_frame_std: Floats
    mean_radius_um: Floats
    mean_radius_std_um: Floats
    sauter_radius_um: Floats
    """Half of d32: sum of r^3 over sum of r^2."""
    sauter_radius_std_um: Floats
    fraction: Floats
    """Volume of droplets per observed volume, or area of their disks per area where the depth is unknown."""
    fraction_std: Floats
    is_volume_fraction: bool
    percentiles_um: Floats
    """Radii at `PERCENTILES`, shape (n_columns, 3), interpolated in log r within the bins."""


def size_moments(
    histograms: FrameHistograms,
    *,
    area_um2: float,
    observation_depth_um: float | Floats | None = None,
    seen: InSight | None = None,
) -> SizeMoments:
    """Number, mean radius, Sauter radius, volume (or area) fraction and percentiles of each column.

    Means, and the fraction where the depth is one number, come from the moment sums, exactly; all else from the bins.
    """
    number, sum_r, sum_r2, sum_r3 = histograms.moments.T
    radius_um = histograms.radius_um
    power = 2.0 if observation_depth_um is None else 3.0
    shape = np.pi if observation_depth_um is None else 4 / 3 * np.pi
    depth_um = 1.0 if observation_depth_um is None else observation_depth_um
    filled = shape * radius_um**power / (area_um2 * depth_um)
    sum_filled = (
        shape * (sum_r2 if power == 2 else sum_r3) / (area_um2 * depth_um)
        if np.ndim(depth_um) == 0
        else (histograms.counts * filled).sum(axis=1)
    )
    variance = histograms.counts * _variance_factor(histograms, seen)
    with np.errstate(invalid="ignore", divide="ignore"):
        # Of all droplets together, where some are outside the bins.
        factor = np.nan_to_num(variance.sum(axis=1) / histograms.counts.sum(axis=1), nan=1.0)
        mean_um = sum_r / number
        sauter_um = sum_r3 / sum_r2
        mean_std_um = np.sqrt(factor * np.maximum(sum_r2 / number - mean_um**2, 0) / number)
        pull = radius_um**3 - sauter_um[:, None] * radius_um**2
        sauter_std_um = np.sqrt((variance * pull**2).sum(axis=1)) / sum_r2
    return SizeMoments(
        n_per_frame=number / histograms.n_frames,
        n_per_frame_std=np.sqrt(factor * number) / histograms.n_frames,
        mean_radius_um=mean_um,
        mean_radius_std_um=mean_std_um,
        sauter_radius_um=sauter_um,
        sauter_radius_std_um=sauter_std_um,
        fraction=np.asarray(sum_filled / histograms.n_frames),
        fraction_std=np.sqrt((variance * filled**2).sum(axis=1)) / histograms.n_frames,
        is_volume_fraction=observation_depth_um is not None,
        percentiles_um=percentiles(histograms),
    )


def percentiles(histograms: FrameHistograms) -> Floats:
    """Radii below which 10, 50 and 90 % of the binned droplets lie, shape (n_columns, 3), NaN where there is none."""
    log_edges = np.log(histograms.edges_um)
    found = np.full((len(histograms), len(PERCENTILES)), np.nan)
    for column in np.flatnonzero(histograms.counts.sum(axis=1)):
        cumulated = np.concatenate([[0], np.cumsum(histograms.counts[column])])
        wanted = np.array(PERCENTILES) / 100 * cumulated[-1]
        found[column] = np.exp(np.interp(wanted, cumulated, log_edges))
    return found
