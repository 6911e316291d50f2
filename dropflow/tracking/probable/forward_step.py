"""One step forward by probability: which detections are which droplets, and the flow between."""

from dataclasses import dataclass

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.first_flow import elect_pairs
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.identification import Pairs
from dropflow.tracking.prediction import Motion, moved
from dropflow.tracking.probable.association import Association, Chances, associate
from dropflow.tracking.probable.expectation import Expectation, Predicted
from dropflow.tracking.probable.flow_memory import FlowMemory
from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.memory import Memory
from dropflow.tracking.probable.observing import deviations, observe, trusted
from dropflow.tracking.probable.regression import WaveFlow, regress
from dropflow.tracking.probable.scales import Scales

_MOST_ROUNDS = 6
"""Of pairs and flow in turn, when nothing was known."""
_ITERATIONS_AGAIN = 6
"""For the spectrum, when a few more pairs have been found."""
_LOST_SHARE = 0.3
"""When fewer of the droplets than this are found where the flow takes them, the flow is not what it was."""
_LEAST_ELECTED = 4
"""An election of fewer droplets decides nothing."""
_LEAST_SURPRISES = 0.5
"""A frame with fewer unexpected detections than this, on average, is not thought of."""


@dataclass(frozen=True)
class Outcome:
    """What was found out in a step."""

    predicted: Predicted
    association: Association
    seen: Observations
    flow: WaveFlow | None


@dataclass(frozen=True)
class ForwardStep:
    """What is given in a step."""

    droplets: Droplets
    memory: Memory
    """Of the same droplets."""
    detected: Droplets
    grid: Grid
    motion: Motion
    known: FlowMemory
    scales: Scales
    dt_s: float

    def solve(self) -> Outcome:
        """Pairs under the flow that was, the flow of these pairs, and pairs under that."""
        predicted, association = self._associate(self.known.last, self.known.change_um_s2 * self.dt_s)
        flow = self.known.last
        if self.known.may_be_sought and (flow is None or self._is_lost(association)):
            first = self._flow_from_nothing()
            if first is not None:
                flow = first
                predicted, association = self._associate(flow, 0.0)
        seen = self._seen(association)
        if flow is not None:
            flow = self.known.flow_with(seen, self.dt_s)
            predicted, association = self._associate(flow, 0.0)
            seen = self._seen(association)
        return Outcome(predicted, association, seen, flow)

    @property
    def _spacing_px(self) -> float:
        return self.grid.spacing_px(max(len(self.detected), len(self.droplets)))

    def _associate(self, flow: WaveFlow | None, change_um_s: float) -> tuple[Predicted, Association]:
        known = self.known
        stokes_error = known.stokes_error if flow is None else flow.stokes_error
        expectation = Expectation(
            self.motion, flow, change_um_s, stokes_error, known.noise_um_s, self._spacing_px, self.scales.widening
        )
        predicted = expectation.of(self.droplets, self.memory, self.dt_s)
        surprises = max(self.scales.surprising * len(self.detected), _LEAST_SURPRISES)
        chances = Chances(self.scales.detected, surprises / (self.grid.height_px * self.grid.width_px))
        return predicted, associate(predicted, self.detected, chances)

    def _seen(self, association: Association) -> Observations:
        """What probable pairs say of the flow."""
        pairs = association.pairs()
        weight = association.of(pairs, association.probability, 0.0)
        return trusted(self._observe(pairs, weight), association.of(pairs, association.squared_distance, 0.0))

    def _observe(self, pairs: Pairs, weight: Column) -> Observations:
        after = self.detected[pairs.second]
        memory = self.memory[pairs.first].measured(after.r_px, after.r_std_px)
        before = self.droplets[pairs.first]
        return observe(
            self.motion,
            before,
            after,
            self.dt_s,
            log_r=memory.log_r,
            log_r_variance=memory.log_r_variance,
            weight=weight,
        )

    def _is_lost(self, association: Association) -> bool:
        """Whether far fewer droplets than usual are where the flow took them."""
        n_possible = min(len(self.droplets), len(self.detected))
        return n_possible >= 2 * _LEAST_ELECTED and bool(association.probability.sum() < _LOST_SHARE * n_possible)

    def _flow_from_nothing(self) -> WaveFlow | None:
        """The flow by elected displacements, then by pairs and flow in turn."""
        n_possible = min(len(self.droplets), len(self.detected))
        sinking_px = self.motion.sinking_px(np.exp(self.memory.log_r), self.dt_s)
        sunk = moved(self.droplets, sinking_px * (1 + self.known.stokes_error[0]))
        pairs = elect_pairs(sunk, self.detected, spacing_px=self._spacing_px)
        if n_possible >= _LEAST_ELECTED:
            self.known.note_search(has_failed=len(pairs) < _LEAST_ELECTED)
        if len(pairs) < _LEAST_ELECTED:
            return None
        self.known.forget()
        seen = self._observe(pairs, np.ones(len(pairs)))
        flow = self._fitted(seen)
        for _ in range(_MOST_ROUNDS):
            again = self._seen(self._associate(flow, 0.0)[1])
            if len(again) <= len(seen):
                break
            seen, flow = again, self._fitted(again, most_iterations=_ITERATIONS_AGAIN)
        return flow

    def _fitted(self, seen: Observations, most_iterations: int = 25) -> WaveFlow:
        """The flow under the model that suits these observations best, outliers weighing less."""
        self.known.estimate([seen], most_iterations=most_iterations)
        model = self.known.model
        assert model is not None  # noqa: S101 - it was estimated in the line before
        flow = regress(seen, model)
        across, along = deviations(seen, flow)
        noise = model.spectrum.noise_um_s**2
        squared = across**2 / (seen.across_variance + noise) + along**2 / (seen.along_variance + noise)
        return regress(trusted(seen, np.asarray(squared)), model)
