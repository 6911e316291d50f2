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
from dropflow.tracking.probable.lost_places import LostPlaces, lost_places
from dropflow.tracking.probable.memory import Memory
from dropflow.tracking.probable.observing import along, deviations, observe, trusted
from dropflow.tracking.probable.regression import WaveFlow, regress
from dropflow.tracking.probable.scales import Scales
from dropflow.tracking.probable.ways import Ways

_MOST_ROUNDS = 6
"""Of pairs and flow in turn, when nothing was known."""
_ITERATIONS_AGAIN = 6
"""For the spectrum, when a few more pairs have been found."""
_MOST_RECOVERIES, _MOST_GROWTHS = 4, 3
"""Times that the flow is found again where it was wrong, and rounds of pairs and flow in each."""
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
        found = self._under(self.known.last, self.known.change_um_s2 * self.dt_s)
        if self.known.may_be_sought and (found.flow is None or self._is_lost(found.association)):
            first = self._flow_from_nothing()
            if first is not None:
                found = self._under(first)
        if found.flow is not None:
            found = self._recovered(self._under(self.known.flow_with(found.seen, self.dt_s)))
        return found

    def _under(self, flow: WaveFlow | None, change_um_s: float = 0.0) -> Outcome:
        """What is seen under a flow."""
        predicted, association = self._associate(flow, change_um_s)
        return Outcome(predicted, association, self._seen(predicted, association), flow)

    def _recovered(self, found: Outcome) -> Outcome:
        """Where droplets are missing all around, the flow was wrong: it is found again from those around the place."""
        for _ in range(_MOST_RECOVERIES):
            lost = self._lost_places(found)
            if lost is None:
                break
            again = self._grown(lost.without(found.seen), lost)
            if again.association.probability.sum() <= found.association.probability.sum():
                break
            self.known.forget_places(lost)
            found = again
        return found

    def _lost_places(self, found: Outcome) -> LostPlaces | None:
        place = found.predicted.droplets
        is_found = np.zeros(len(place), bool)
        is_found[found.association.pairs().first] = True
        inside = self.grid.contains(place.x_px, place.y_px) & (self.memory.n_undetected == 0)
        return lost_places(place.x_px[inside], place.y_px[inside], is_found[inside])

    def _grown(self, seen: Observations, lost: LostPlaces) -> Outcome:
        """Pairs and flow in turn, as long as there are more and more pairs; nothing is known of the lost places."""
        found = self._under(self.known.flow_with(seen, self.dt_s, lost))
        for _ in range(_MOST_GROWTHS):
            again = self._under(self.known.flow_with(found.seen, self.dt_s, lost))
            if len(again.seen) <= len(found.seen):
                break
            found = again
        return found

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

    def _seen(self, predicted: Predicted, association: Association) -> Observations:
        """What probable pairs say of the flow."""
        pairs = association.pairs()
        weight = association.of(pairs, association.probability, 0.0)
        return trusted(
            self._observe(pairs, weight, predicted.ways), association.of(pairs, association.squared_distance, 0.0)
        )

    def _observe(self, pairs: Pairs, weight: Column, thought: Ways | None = None) -> Observations:
        after = self.detected[pairs.second]
        memory = self.memory[pairs.first].measured(after.r_px, after.r_std_px)
        before = self.droplets[pairs.first]
        seen = observe(
            self.motion,
            before,
            after,
            self.dt_s,
            log_r=memory.log_r,
            log_r_variance=memory.log_r_variance,
            weight=weight,
        )
        if thought is None:
            return seen
        return along(seen, thought[pairs.first], self.motion.up, self.dt_s / self.motion.pixel_size_um)

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
        seen = self._observe(
            pairs, np.ones(len(pairs)), self._under(flow).predicted.ways
        )  # along the turns of the flow, now that it is known
        flow = self._fitted(seen, most_iterations=_ITERATIONS_AGAIN)
        for _ in range(_MOST_ROUNDS):
            again = self._under(flow).seen
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
