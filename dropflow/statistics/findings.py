"""All statistics of one film, each computed when it is first asked for, over a range of times and radii."""

from functools import cached_property

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.experiment import FixedMaterial
from dropflow.physics.material import MixtureProperties
from dropflow.physics.temperature_log import Driving, TemperatureLog, driving_from_log
from dropflow.statistics.calibration import Calibration
from dropflow.statistics.coalescence import CoalescenceRates, coalescence_rates
from dropflow.statistics.condensed import N_RADIUS_BINS, Condensed, statistics_edges_um
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_bins import BinnedFlow, bin_flow, edges_of_oscillations
from dropflow.statistics.flow_correlation import FlowCorrelation
from dropflow.statistics.flow_moments import FlowMoments, coarsen_flow
from dropflow.statistics.growth import Growth, growth_by_radius, swept_growth_um_s
from dropflow.statistics.histograms import FrameHistograms, coarsen, radius_edges_um
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.lengths import ObservedDepth, TrajectoryLengths, trajectory_lengths
from dropflow.statistics.oscillations import Oscillations, Signal, find_oscillations
from dropflow.statistics.scope import Scope
from dropflow.statistics.sedimentation import RadiusScatter, VelocityByRadius, radius_scatter, velocity_by_radius
from dropflow.statistics.size_distribution import size_distribution

Floats = npt.NDArray[np.float64]

_SHOWN_STEPS = 1500
_FLOW_BINS = 40
"""Of a film without oscillations."""


class Findings:
    """What an analysis says, as numbers; figures, tables and the report are made from it.

    Parameters
    ----------
    facts
        What was filmed.
    condensed
        What was computed from the tables.
    scope
        Times and radii looked at. The observed depth, the correlation of the flow and the self-calibration are always
        those of the whole film.
    signal
        In what oscillations are looked for.
    temperature
        A log to use instead of the one that the film was analysed with.
    """

    def __init__(
        self,
        facts: FilmFacts,
        condensed: Condensed,
        *,
        scope: Scope | None = None,
        signal: Signal = Signal.N_DROPLETS,
        temperature: TemperatureLog | None = None,
    ) -> None:
        self.facts, self.condensed = facts, condensed
        self.scope, self.signal = scope or Scope(), signal
        self._given_temperature = temperature

    @cached_property
    def before(self) -> FrameHistograms:
        """All detections."""
        return self.scope.histograms(self.condensed.before)

    @cached_property
    def after(self) -> FrameHistograms:
        """What tracking leaves of them."""
        return self.scope.histograms(self.condensed.after)

    @property
    def shown_sizes(self) -> FrameHistograms:
        """Droplets of trajectories, or all detections while nothing was tracked, and of a frame that stands alone."""
        return self.after if len(self.after) and self.facts.n_frames > 1 else self.before

    @cached_property
    def trajectories(self) -> pl.DataFrame:
        """One row a trajectory."""
        return self.scope.trajectories(self.condensed.trajectories)

    @cached_property
    def flow(self) -> FlowMoments:
        """Mean and rms of the flow of each step."""
        return self.scope.flow(self.condensed.flow)

    @cached_property
    def shown_flow(self) -> FlowMoments:
        """The same with neighbouring steps together where there are more than can be shown."""
        return coarsen_flow(self.flow, _SHOWN_STEPS)

    @property
    def correlation(self) -> FlowCorrelation:
        """Correlation of the flow."""
        return self.condensed.correlation

    @property
    def calibration(self) -> Calibration:
        """Density difference over viscosity from velocities."""
        return self.condensed.calibration

    @property
    def depth(self) -> ObservedDepth:
        """Depth from how long droplets stay in sight."""
        return self.condensed.depth

    @cached_property
    def material(self) -> FixedMaterial:
        """Means over the frames looked at."""
        clock = self.condensed.clock
        inside = self.scope.times(clock.time_s)
        inside = inside if inside.any() else np.ones_like(inside)
        return FixedMaterial(
            delta_density_kg_m3=float(clock.delta_density_kg_m3[inside].mean()),
            viscosity_pa_s=float(clock.viscosity_pa_s[inside].mean()),
        )

    @cached_property
    def temperature(self) -> TemperatureLog | None:
        """Temperature of each frame, where there is a log."""
        clock = self.condensed.clock
        if self._given_temperature is not None:
            return TemperatureLog(clock.time_s, self._given_temperature.at(clock.time_s))
        return TemperatureLog(clock.time_s, clock.temperature_c) if len(clock.temperature_c) else None

    @cached_property
    def shown_temperature(self) -> TemperatureLog:
        """Temperature of the frames looked at; empty where there is no log."""
        found = self.temperature
        if found is None:
            return TemperatureLog(np.empty(0), np.empty(0))
        inside = self.scope.times(found.time_s)
        return TemperatureLog(found.time_s[inside], found.temperature_c[inside])

    @cached_property
    def driving(self) -> Driving | None:
        """Xi over time, where temperature and binodal are known."""
        if self.temperature is None or self.facts.mixture is None:
            return None
        found = driving_from_log(self.temperature, MixtureProperties(self.facts.mixture).binodal)
        inside = self.scope.times(found.time_s)
        return Driving(
            found.time_s[inside],
            found.temperature_c[inside],
            found.driving_per_s[inside],
            found.driving_std_per_s[inside],
        )

    @cached_property
    def edges_um(self) -> Floats:
        """Edges of the radius bins of statistics against radius."""
        detection, scope = self.facts.parameters.detection, self.scope
        low, high = scope.radius_min_um or detection.radius_min_um, scope.radius_max_um or detection.radius_max_um
        return radius_edges_um(low, high, N_RADIUS_BINS)

    @cached_property
    def seen(self) -> InSight | None:
        """How long droplets stay in sight."""
        whole = self.condensed.seen
        return None if whole is None else self.scope.seen(whole, self.condensed.before.radius_um)

    @cached_property
    def depth_um(self) -> float | Floats | None:
        """Observed depth: the experiment's, one for each fine bin by the fitted factor, or None where none is known."""
        given_um = self.facts.experiment.observation_depth_um
        if given_um is not None:
            return given_um
        return self.depth.at(self.before.radius_um) if np.isfinite(self.depth.per_radius) else None

    @cached_property
    def velocity(self) -> VelocityByRadius:
        """Velocity along up against radius."""
        return velocity_by_radius(
            self.trajectories, self.edges_um, mean_upward_flow_um_s=_mean(self.flow.mean_um_s[:, 1])
        )

    @cached_property
    def scatter(self) -> RadiusScatter:
        """Scatter of the radius within trajectories."""
        return radius_scatter(self.trajectories, self.edges_um)

    @cached_property
    def lengths(self) -> TrajectoryLengths:
        """Length of trajectories against radius."""
        return trajectory_lengths(self.trajectories, self.edges_um, frame_height_um=self.facts.extent_um[1])

    @cached_property
    def whole_lengths(self) -> TrajectoryLengths:
        """The same of the whole film, in the bins of the observed depth."""
        edges_um = statistics_edges_um(self.facts)
        return trajectory_lengths(self.condensed.trajectories, edges_um, frame_height_um=self.facts.extent_um[1])

    @cached_property
    def growth(self) -> Growth:
        """Growth against radius."""
        return growth_by_radius(self.trajectories, self.edges_um)

    @cached_property
    def swept_um_s(self) -> Floats | None:
        """Growth of droplets that take up all smaller ones in their way; None where the depth is unknown."""
        whole = Scope(self.scope.from_s, self.scope.to_s).histograms(self.condensed.after)
        depth_um = self.facts.experiment.observation_depth_um or (
            self.depth.at(whole.radius_um) if np.isfinite(self.depth.per_radius) else None
        )
        if depth_um is None or not len(whole):
            return None
        mean = coarsen(whole, 1)
        density = size_distribution(mean, area_um2=self.facts.area_um2, observation_depth_um=depth_um)
        return swept_growth_um_s(
            self.growth.rate.x,
            whole.radius_um,
            density.density[0] * np.diff(whole.edges_um),
            delta_density_kg_m3=self.material.delta_density_kg_m3,
            viscosity_pa_s=self.material.viscosity_pa_s,
        )

    @cached_property
    def events(self) -> pl.DataFrame:
        """Coalescences."""
        return self.scope.events(self.condensed.events)

    @cached_property
    def rates(self) -> CoalescenceRates:
        """Rates of coalescence by size pair."""
        return coalescence_rates(
            self.events, self.edges_um[::2], area_um2=self.facts.area_um2, duration_s=self.duration_s
        )

    @property
    def duration_s(self) -> float:
        """Of the frames looked at."""
        time_s = self.condensed.clock.time_s
        inside = time_s[self.scope.times(time_s)]
        return float(np.ptp(inside)) if len(inside) else 0.0

    @cached_property
    def oscillations(self) -> Oscillations:
        """Oscillations of the signal."""
        return find_oscillations(self.after, signal=self.signal)

    @cached_property
    def binned_flow(self) -> BinnedFlow:
        """Moments of the flow in four bins an oscillation, or forty over the film where there are no oscillations."""
        peak_s, time_s = self.oscillations.peak_s, self.flow.time_s
        if len(peak_s) >= 2:
            edges_s = edges_of_oscillations(peak_s)
        elif len(time_s) > 1:
            edges_s = np.linspace(time_s[0], time_s[-1] * (1 + 1e-9) + 1e-9, min(_FLOW_BINS, len(time_s)) + 1)
        else:
            edges_s = np.append(time_s, time_s + 1.0)
        known = np.isfinite(self.correlation.time_s)
        return bin_flow(self.flow, edges_s, correlation_time_s=self.correlation.time_s if known else 0.0)


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else 0.0
