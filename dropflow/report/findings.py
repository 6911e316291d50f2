"""All statistics of one analysis, computed once."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.experiment import FixedMaterial
from dropflow.physics.material import resolve
from dropflow.physics.temperature_log import TemperatureLog
from dropflow.results import Results
from dropflow.statistics.calibration import Calibration, expected_density_over_viscosity, self_calibration
from dropflow.statistics.coalescence import CoalescenceRates, coalescence_events, coalescence_rates
from dropflow.statistics.flow_bins import BinnedFlow, bin_flow, edges_of_oscillations
from dropflow.statistics.flow_correlation import FlowCorrelation, flow_correlation
from dropflow.statistics.flow_moments import FlowMoments, flow_moments
from dropflow.statistics.growth import Growth, growth_by_radius, swept_growth_um_s
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.lengths import ObservedDepth, TrajectoryLengths, observed_depth, trajectory_lengths
from dropflow.statistics.oscillations import Oscillations, Signal, find_oscillations
from dropflow.statistics.sedimentation import RadiusScatter, VelocityByRadius, radius_scatter, velocity_by_radius
from dropflow.statistics.size_distribution import size_distribution
from dropflow.statistics.table_histograms import histograms_of_table
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories

Floats = npt.NDArray[np.float64]

N_RADIUS_BINS = 20
_FALLBACK_RADIUS_STD = 0.05


@dataclass(frozen=True)
class Findings:
    """What an analysis says, as numbers; figures and the report are made from it."""

    material: FixedMaterial
    temperature: TemperatureLog | None
    trajectories: pl.DataFrame
    before: FrameHistograms
    after: FrameHistograms
    depth_um: float | Floats | None
    """Observed depth: the experiment's, or one for each bin by the fitted factor, or None where neither is known."""
    depth: ObservedDepth
    velocity: VelocityByRadius
    scatter: RadiusScatter
    lengths: TrajectoryLengths
    growth: Growth
    swept_um_s: Floats | None
    events: pl.DataFrame
    rates: CoalescenceRates
    flow: FlowMoments
    binned_flow: BinnedFlow
    correlation: FlowCorrelation
    oscillations: Oscillations
    calibration: Calibration

    @property
    def expected_calibration_s_m2(self) -> float:
        """The material's density difference over its viscosity."""
        return expected_density_over_viscosity(self.material.delta_density_kg_m3, self.material.viscosity_pa_s)


def find(
    results: Results, *, signal: Signal = Signal.N_DROPLETS, temperature: TemperatureLog | None = None
) -> Findings:
    """Compute every statistic of an analysis; tables are streamed."""
    experiment, detection = results.experiment, results.parameters.detection
    material = resolve(experiment)
    rows = open_trajectories(results.trajectories)
    trajectories = summarise_trajectories(rows, experiment.up)
    fine_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um, N_RADIUS_BINS)
    before = histograms_of_table(results.droplets, fine_um, results.times_s)
    after = histograms_of_table(results.trajectories, fine_um, results.times_s)
    flow = flow_moments(results.flow, experiment.up)
    oscillations = find_oscillations(after, signal=signal)
    correlation = flow_correlation(results.flow, pixel_size_um=experiment.pixel_size_um)
    across_um, along_um = _turned(results.field_um, experiment.up)
    sideways_um_s = _mean_sideways_um_s(flow)
    depth = observed_depth(
        trajectories,
        edges_um,
        frame_size_um=(across_um, along_um),
        depth_speed_um_s=sideways_um_s,
        sideways_speed_um_s=sideways_um_s,
    )
    depth_um = _depth(experiment.observation_depth_um, depth, after)
    scatter = radius_scatter(trajectories, edges_um)
    relative_std = scatter.relative if np.isfinite(scatter.relative) else _FALLBACK_RADIUS_STD
    width_um, height_um = results.field_um
    # Means of three frames at either end vary less than single radii.
    events = coalescence_events(
        trajectories, relative_radius_std=max(relative_std, 0.01) / np.sqrt(3), frame_shape_um=(height_um, width_um)
    )
    duration_s = float(np.ptp(results.times_s)) if results.n_frames else 0.0
    growth = growth_by_radius(trajectories, edges_um)
    return Findings(
        material=material,
        temperature=temperature,
        trajectories=trajectories,
        before=before,
        after=after,
        depth_um=depth_um,
        depth=depth,
        velocity=velocity_by_radius(trajectories, edges_um, mean_upward_flow_um_s=_mean(flow.mean_um_s[:, 1])),
        scatter=scatter,
        lengths=trajectory_lengths(trajectories, edges_um, frame_height_um=along_um),
        growth=growth,
        swept_um_s=_swept(growth, after, results.area_um2, depth_um, material),
        events=events,
        rates=coalescence_rates(events, edges_um[::2], area_um2=results.area_um2, duration_s=duration_s),
        flow=flow,
        binned_flow=_binned(flow, oscillations, correlation),
        correlation=correlation,
        oscillations=oscillations,
        calibration=self_calibration(rows, experiment.up, field_um=results.field_um),
    )


def _depth(given_um: float | None, fitted: ObservedDepth, histograms: FrameHistograms) -> float | Floats | None:
    if given_um is not None:
        return given_um
    return fitted.at(histograms.radius_um) if np.isfinite(fitted.per_radius) else None


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else 0.0


def _mean_sideways_um_s(flow: FlowMoments) -> float:
    """Mean magnitude of the horizontal flow; of a Gaussian it is sqrt(2 / pi) of the rms."""
    return float(np.sqrt(2 / np.pi)) * _mean(flow.rms_um_s[:, 0])


def _turned(field_um: tuple[float, float], up: tuple[float, float]) -> tuple[float, float]:
    """Extent of the frame across gravity and along it."""
    width_um, height_um = field_um
    return (
        abs(up[1]) * width_um + abs(up[0]) * height_um,
        abs(up[0]) * width_um + abs(up[1]) * height_um,
    )


def _binned(flow: FlowMoments, oscillations: Oscillations, correlation: FlowCorrelation) -> BinnedFlow:
    """Four bins an oscillation, or forty over the film where there are no oscillations."""
    if len(oscillations.peak_s) >= 2:
        edges_s = edges_of_oscillations(oscillations.peak_s)
    elif len(flow.time_s) > 1:
        edges_s = np.linspace(flow.time_s[0], flow.time_s[-1] * (1 + 1e-9) + 1e-9, min(40, len(flow.time_s)) + 1)
    else:
        edges_s = np.append(flow.time_s, flow.time_s + 1.0)
    known = np.isfinite(correlation.time_s)
    return bin_flow(flow, edges_s, correlation_time_s=correlation.time_s if known else 0.0)


def _swept(
    growth: Growth, after: FrameHistograms, area_um2: float, depth_um: float | Floats | None, material: FixedMaterial
) -> Floats | None:
    if depth_um is None or not len(after):
        return None
    density = size_distribution(after, area_um2=area_um2, observation_depth_um=depth_um)
    per_volume = (density.density * np.diff(after.edges_um)).mean(axis=0)
    return swept_growth_um_s(
        growth.rate.x,
        after.radius_um,
        per_volume,
        delta_density_kg_m3=material.delta_density_kg_m3,
        viscosity_pa_s=material.viscosity_pa_s,
    )
