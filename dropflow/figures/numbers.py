"""The numbers behind each figure as a table; names of columns carry units."""

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.statistics.binned import BinnedMean
from dropflow.statistics.findings import Findings
from dropflow.statistics.growth import collision_efficiency
from dropflow.statistics.histograms import FrameHistograms, coarsen
from dropflow.statistics.size_distribution import PERCENTILES, size_moments
from dropflow.statistics.size_distribution import size_distribution as density_of

Floats = npt.NDArray[np.float64]

MAX_COLUMNS = 600


def distribution(found: Findings, histograms: FrameHistograms) -> pl.DataFrame:
    """One row a column of time and a bin of radius."""
    shown = coarsen(histograms, MAX_COLUMNS)
    density = density_of(shown, area_um2=found.facts.area_um2, observation_depth_um=found.depth_um, seen=found.seen)
    unit = density.unit.replace("^-", "_minus_")
    n_bins = len(shown.radius_um)
    return pl.DataFrame(
        {
            "time_s": np.repeat(shown.time_s, n_bins),
            "n_frames": np.repeat(shown.n_frames, n_bins),
            "radius_from_um": np.tile(shown.edges_um[:-1], len(shown)),
            "radius_to_um": np.tile(shown.edges_um[1:], len(shown)),
            "n_droplets": shown.counts.ravel(),
            f"density_{unit}": density.density.ravel(),
            f"density_std_{unit}": density.density_std.ravel(),
        }
    )


def distribution_before(found: Findings) -> pl.DataFrame:
    """Of all detections."""
    return distribution(found, found.before)


def distribution_after(found: Findings) -> pl.DataFrame:
    """Of droplets that count after tracking."""
    return distribution(found, found.after)


def distribution_at(found: Findings) -> pl.DataFrame:
    """One row a bin of radius, before and after the consistency check."""
    parts = []
    for which, histograms in (("detected", found.before), ("tracked", found.after)):
        whole = distribution(found, coarsen(histograms, 1) if len(histograms) else histograms)
        parts.append(whole.select(pl.lit(which).alias("which"), pl.all()))
    return pl.concat(parts)


def moments(found: Findings) -> pl.DataFrame:
    """One row a column of time."""
    shown = coarsen(found.shown_sizes, MAX_COLUMNS)
    of = size_moments(shown, area_um2=found.facts.area_um2, observation_depth_um=found.depth_um, seen=found.seen)
    fraction = "volume_fraction" if of.is_volume_fraction else "area_fraction"
    percentiles = {f"radius_p{p:.0f}_um": of.percentiles_um[:, i] for i, p in enumerate(PERCENTILES)}
    return pl.DataFrame(
        {
            "time_s": shown.time_s,
            "n_frames": shown.n_frames,
            "n_droplets_per_frame": of.n_per_frame,
            "n_droplets_per_frame_std": of.n_per_frame_std,
            "mean_radius_um": of.mean_radius_um,
            "mean_radius_std_um": of.mean_radius_std_um,
            "sauter_radius_um": of.sauter_radius_um,
            "sauter_radius_std_um": of.sauter_radius_std_um,
            fraction: of.fraction,
            f"{fraction}_std": of.fraction_std,
            **percentiles,
        }
    )


def _binned(of: BinnedMean, value: str) -> dict[str, Floats | npt.NDArray[np.int64]]:
    name, _, unit = value.partition("|")
    return {
        "radius_from_um": of.edges[:-1],
        "radius_to_um": of.edges[1:],
        "radius_mean_um": of.x,
        "n_trajectories": of.n,
        f"{name}_{unit}": of.mean,
        f"{name}_standard_error_{unit}": of.standard_error,
    }


def velocity(found: Findings) -> pl.DataFrame:
    """One row a bin of radius."""
    of = found.velocity
    return pl.DataFrame(
        {
            **_binned(of.measured, "velocity|um_s"),
            "radius_std_um": of.radius_std_um,
            "stokes_and_mean_flow_um_s": of.expected_um_s,
            "mean_flow_um_s": np.full(len(of.expected_um_s), of.flow_um_s),
        }
    )


def lengths(found: Findings) -> pl.DataFrame:
    """One row a bin of radius: mean and bound; counts by duration stand in trajectory_summary.parquet."""
    of = found.lengths
    return pl.DataFrame({**_binned(of.mean_s, "duration|s"), "bound_s": of.bound_s})


def depth(found: Findings) -> pl.DataFrame:
    """One row a bin of radius, and the fitted factor."""
    of, mean = found.depth, found.whole_lengths.mean_s
    n = len(of.depth_um)
    return pl.DataFrame(
        {
            "radius_mean_um": mean.x,
            "n_trajectories": mean.n,
            "depth_um": of.depth_um,
            "depth_per_radius": np.full(n, of.per_radius),
            "depth_per_radius_std": np.full(n, of.per_radius_std),
        }
    )


def scatter(found: Findings) -> pl.DataFrame:
    """One row a bin of radius."""
    of = found.scatter
    n = len(of.scatter.n)
    return pl.DataFrame(
        {
            **_binned(of.scatter, "radius_scatter|um"),
            "relative_scatter": np.full(n, of.relative),
            "relative_scatter_std": np.full(n, of.relative_std),
        }
    )


def calibration(found: Findings) -> pl.DataFrame:
    """One row a bin of the deviation of r^2."""
    of = found.calibration
    n = len(of.r2_um2)
    return pl.DataFrame(
        {
            "r2_deviation_um2": of.r2_um2,
            "velocity_deviation_um_s": of.along_um_s,
            "velocity_deviation_standard_error_um_s": of.along_std_um_s,
            "density_over_viscosity_s_m2": np.full(n, of.density_over_viscosity_s_m2),
            "density_over_viscosity_std_s_m2": np.full(n, of.std_s_m2),
            "material_s_m2": np.full(n, of.expected_s_m2),
        }
    )


def growth(found: Findings) -> pl.DataFrame:
    """One row a bin of radius."""
    swept = found.swept_um_s
    n = len(found.growth.rate.n)
    return pl.DataFrame(
        {
            **_binned(found.growth.rate, "growth|um_s"),
            "growth_at_efficiency_1_um_s": np.full(n, np.nan) if swept is None else swept,
        }
    )


def efficiency(found: Findings) -> pl.DataFrame:
    """One row a bin of radius."""
    rate, swept = found.growth.rate, found.swept_um_s
    nothing = np.full(len(rate.n), np.nan)
    share, error = (nothing, nothing) if swept is None else collision_efficiency(found.growth, swept)
    return pl.DataFrame(
        {
            "radius_mean_um": rate.x,
            "n_trajectories": rate.n,
            "collision_efficiency": share,
            "collision_efficiency_standard_error": error,
        }
    )


def coalescence(found: Findings) -> pl.DataFrame:
    """One row a pair of size bins."""
    of = found.rates
    smaller, larger = np.meshgrid(np.arange(len(of.edges_um) - 1), np.arange(len(of.edges_um) - 1), indexing="ij")
    is_pair = smaller <= larger
    low, high = smaller[is_pair], larger[is_pair]
    with np.errstate(invalid="ignore", divide="ignore"):
        std = of.rate_per_um2_s / np.sqrt(of.counts)
    return pl.DataFrame(
        {
            "smaller_from_um": of.edges_um[low],
            "smaller_to_um": of.edges_um[low + 1],
            "larger_from_um": of.edges_um[high],
            "larger_to_um": of.edges_um[high + 1],
            "n_events": of.counts[is_pair],
            "rate_per_um2_s": of.rate_per_um2_s[is_pair],
            "rate_std_per_um2_s": std[is_pair],
        }
    )


def _flow(time_s: Floats, columns: dict[str, Floats]) -> pl.DataFrame:
    split = {
        f"{name}_{direction}_um_s": values[:, i]
        for name, values in columns.items()
        for i, direction in enumerate(("horizontal", "upward"))
    }
    return pl.DataFrame({"time_s": time_s, **split})


def flow_steps(found: Findings) -> pl.DataFrame:
    """One row a step."""
    return _flow(found.flow.time_s, {"mean": found.flow.mean_um_s, "rms": found.flow.rms_um_s})


def flow_bins(found: Findings) -> pl.DataFrame:
    """One row a bin of time."""
    of = found.binned_flow
    columns = {
        "mean": of.mean_um_s,
        "mean_standard_error": of.mean_std_um_s,
        "rms": of.rms_um_s,
        "rms_standard_error": of.rms_std_um_s,
    }
    return _flow(of.time_s, columns)


def correlation(found: Findings) -> pl.DataFrame:
    """One row a distance, then one a lag."""
    of = found.correlation
    parts = [("distance_um", of.distance_um, of.in_space), ("lag_s", of.lag_s, of.in_time)]
    tables = [
        pl.DataFrame({"kind": pl.Series([name] * len(at), dtype=pl.String), "at": at, "correlation": values})
        for name, at, values in parts
    ]
    return pl.concat(tables)


def signal(found: Findings) -> pl.DataFrame:
    """One row a time."""
    of = found.oscillations
    return pl.DataFrame({"time_s": of.time_s, f"{of.signal_name}_over_trend_minus_1": of.signal})


def periods(found: Findings) -> pl.DataFrame:
    """One row a period."""
    of = found.oscillations
    table = pl.DataFrame(
        {
            "begin_s": of.peak_s[:-1],
            "end_s": of.peak_s[1:],
            "period_s": of.period_s,
            "period_std_s": of.period_std_s,
            "is_certain": of.is_period_certain,
        }
    )
    if found.temperature is None or not len(of.period_at_s):
        return table
    return table.with_columns(temperature_c=found.temperature.at(of.period_at_s))


def temperature(found: Findings) -> pl.DataFrame:
    """One row a frame."""
    clock = found.condensed.clock
    inside = found.scope.times(clock.time_s)
    columns = {
        "time_s": clock.time_s,
        "temperature_c": clock.temperature_c,
        "delta_density_kg_m3": clock.delta_density_kg_m3,
        "viscosity_pa_s": clock.viscosity_pa_s,
    }
    return pl.DataFrame({name: values[inside] for name, values in columns.items() if len(values)})


def driving(found: Findings) -> pl.DataFrame:
    """One row a window of time."""
    of = found.driving
    if of is None:
        return pl.DataFrame(schema={"time_s": pl.Float64})
    return pl.DataFrame(
        {
            "time_s": of.time_s,
            "temperature_c": of.temperature_c,
            "driving_per_s": of.driving_per_s,
            "driving_std_per_s": of.driving_std_per_s,
        }
    )
