"""How long droplets are followed, against radius, and the depth in which they are seen (section 4.3, Fig. 10)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.statistics.binned import BinnedMean, binned_mean

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TrajectoryLengths:
    """Trajectories counted by radius and duration."""

    radius_edges_um: Floats
    """Shape (n_radii + 1,)."""
    duration_edges_s: Floats
    """Shape (n_durations + 1,)."""
    counts: npt.NDArray[np.int64]
    """Shape (n_radii, n_durations)."""
    mean_s: BinnedMean
    """Mean duration in each radius bin."""
    bound_s: Floats
    """H / u_sed, the time to sediment through the frame, shape (n_radii,); infinite where nothing sediments."""


def trajectory_lengths(
    trajectories: pl.DataFrame, radius_edges_um: Floats, *, frame_height_um: float, n_durations: int = 40
) -> TrajectoryLengths:
    """Count trajectories by radius and duration, with mean and upper bound.

    `frame_height_um` is the extent of the frame along gravity. A trajectory of n frames lasts from the first to the
    last of them.
    """
    radius = trajectories["r_mean_um"].to_numpy()
    duration_s = (trajectories["end_s"] - trajectories["start_s"]).to_numpy()
    speed = np.abs(trajectories["sedimentation_um_s"].to_numpy())
    longest_s = float(duration_s.max(initial=1.0))
    duration_edges_s = np.linspace(0.0, longest_s * (1 + 1e-9), n_durations + 1)
    counts, _, _ = np.histogram2d(radius, duration_s, bins=(radius_edges_um, duration_edges_s))
    per_r2 = float(np.median(speed / radius**2)) if len(radius) else 0.0
    centres = np.sqrt(radius_edges_um[1:] * radius_edges_um[:-1])
    with np.errstate(divide="ignore"):
        bound_s = frame_height_um / (per_r2 * centres**2)
    mean_s = binned_mean(radius, duration_s, radius_edges_um)
    return TrajectoryLengths(radius_edges_um, duration_edges_s, counts.astype(np.int64), mean_s, bound_s)


@dataclass(frozen=True)
class ObservedDepth:
    """Depth in which a droplet is seen, taken as proportional to its radius."""

    per_radius: float
    """Depth over radius; NaN where it cannot be told."""
    per_radius_std: float
    """Its standard error from the scatter between radius bins."""
    depth_um: Floats
    """What each radius bin gives, NaN where its droplets leave sideways as fast as they are lost, shape (n_radii,)."""

    def at(self, r_um: Floats) -> Floats:
        """Depth for radii, um."""
        return self.per_radius * r_um


def observed_depth(
    trajectories: pl.DataFrame,
    radius_edges_um: Floats,
    *,
    frame_size_um: tuple[float, float],
    depth_speed_um_s: float,
    sideways_speed_um_s: float,
    largest_um: float = 20.0,
    least_trajectories: int = 20,
) -> ObservedDepth:
    """The depth over radius, from how long droplets stay in sight.

    A droplet stays for a mean time T that ends by drifting out of focus, at a rate <|w|> / depth, or over the frame's
    borders, at <|u|> / W + <|v|> / H. What is left of 1 / T after the borders gives the depth of each radius bin; a
    line through the origin over bins up to `largest_um` gives the factor.

    Parameters
    ----------
    trajectories
        One row a trajectory.
    frame_size_um
        Width (across gravity) and height (along it).
    depth_speed_um_s
        Mean |w| of the flow through the focal plane. It is not seen: in a flow alike in all horizontal directions it
        is the mean |u| of the horizontal flow in the image.
    sideways_speed_um_s
        Mean |u| of the horizontal flow in the image.

    Notes
    -----
    Trajectories that break without a reason make the depth too small, those that are cut at the film's ends are
    counted as they are. Take the factor as an estimate; where the optics give a depth, give that.
    """
    radius = trajectories["r_mean_um"].to_numpy()
    duration_s = (trajectories["end_s"] - trajectories["start_s"]).to_numpy()
    n_frames = trajectories["n_frames"].to_numpy().astype(np.float64)
    stay_s = duration_s * n_frames / np.maximum(n_frames - 1, 1)
    stay = binned_mean(radius, stay_s, radius_edges_um)
    rise = binned_mean(radius, np.abs(trajectories["rise_um_s"].to_numpy()), radius_edges_um)
    borders_per_s = sideways_speed_um_s / frame_size_um[0] + rise.mean / frame_size_um[1]
    lost_per_s = 1 / stay.mean - borders_per_s
    is_used = (stay.n >= least_trajectories) & (stay.x <= largest_um) & (lost_per_s > 0.2 / stay.mean)
    depth_um = np.where(is_used, depth_speed_um_s / np.where(is_used, lost_per_s, 1.0), np.nan)
    r, depth, weight = stay.x[is_used], depth_um[is_used], np.sqrt(stay.n[is_used].astype(np.float64))
    if len(r) < 2:
        return ObservedDepth(np.nan, np.nan, depth_um)
    factor = float((weight * r * depth).sum() / (weight * r**2).sum())
    scatter = weight * r * (depth - factor * r)
    std = float(np.sqrt((scatter**2).sum()) / (weight * r**2).sum())
    return ObservedDepth(factor, std, depth_um)
