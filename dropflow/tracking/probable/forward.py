"""Forward tracking by probability (section 3.3.1, with errors)."""

from dataclasses import fields, replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.parameters import Divergence
from dropflow.tracking.chain import StepForward
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.follow import Followed, Look, follow
from dropflow.tracking.front import Front
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.identification import Indices, all_but, same_droplets
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.expectation import Predicted
from dropflow.tracking.probable.flow_memory import FlowMemory
from dropflow.tracking.probable.flow_record import save_flow
from dropflow.tracking.probable.forward_step import ForwardStep, Outcome
from dropflow.tracking.probable.memory import Memory
from dropflow.tracking.probable.observing import along, deviations, observe
from dropflow.tracking.probable.scales import Scales
from dropflow.tracking.probable.search import SIMILAR_RATIO, sure_look
from dropflow.tracking.saving import load_columns, load_front, prefixed, save_columns, save_front, without_prefix

_SURE = 0.9
_MOST_EVIDENCE = 10.0
"""ln odds that a single pair adds at most."""
SIGHTING_EVIDENCE = 1.0
"""Of a droplet that only the image shows where it is looked for: something is often there."""
_MOST_UNDETECTED = 6
"""Frames in a row that a droplet may be seen only where it is looked for, or not at all."""
_MOST_UNSEEN = 2
"""Frames in a row that a droplet may not be seen at all."""
_SURE_EVIDENCE = 5.0
"""ln odds of a trajectory that is waited for."""
_SURE_SPACINGS = 0.3
"""A droplet is waited for where its place is known to this part of the mean spacing."""


class ProbableForward:
    """Goes forward through a film."""

    def __init__(self, grid: Grid, motion: Motion, divergence: Divergence) -> None:
        self._grid = grid
        self._motion = motion
        self._front = Front.empty()
        self._memory = Memory.of_new(np.empty(0), np.empty(0), 0.0)
        self._flow = FlowMemory(grid, motion.up, divergence)
        self._scales = Scales()
        self._next_id = 0

    def step(self, detected: Droplets, look: Look | None, dt_s: float, motion: Motion) -> StepForward:
        """Go on to the frame with these detections."""
        self._motion = motion
        memory = self._memory.aged(dt_s, self._flow.noise_um_s**2)
        outcome = ForwardStep(
            self._front.droplets, memory, detected, self._grid, self._motion, self._flow, self._scales, dt_s
        ).solve()
        predicted = outcome.predicted.droplets
        followed = follow(
            predicted,
            outcome.association.pairs(),
            detected,
            taken=Droplets.empty(),
            look=None if look is None else sure_look(look, outcome.predicted),
            similar_ratio=SIMILAR_RATIO,
        )
        self._note(outcome, len(detected))
        self._flow.learn(outcome.seen, outcome.flow, dt_s)
        self._continue(memory, detected, followed, outcome, dt_s)
        return StepForward(self._front, {} if outcome.flow is None else save_flow(outcome.flow))

    def _note(self, outcome: Outcome, n_detected: int) -> None:
        predicted, association = outcome.predicted.droplets, outcome.association
        self._scales = self._scales.after(
            n_expected=int(self._grid.contains(predicted.x_px, predicted.y_px).sum()),
            n_paired=int(association.is_taken().sum()),
            n_found=n_detected,
            squared_distance=association.squared_distance[association.probability > _SURE],
        )

    def _continue(self, memory: Memory, detected: Droplets, followed: Followed, outcome: Outcome, dt_s: float) -> None:
        """Put together the droplets that were found again, those that may only be hidden, and the new ones."""
        paired, searched = followed.paired, followed.searched
        again = np.concatenate([paired.first, searched])
        there = Droplets.concatenate([detected[paired.second], followed.sighted])
        seen = memory[again].measured(there.r_px, there.r_std_px)
        seen = self._with_own_ways(seen, again, there, outcome, dt_s)
        probability = outcome.association.of(paired, outcome.association.probability, 0.5)
        evidence = np.append(log_odds(probability), np.full(len(searched), SIGHTING_EVIDENCE))
        n_undetected = np.append(np.zeros(len(paired), np.int64), memory.n_undetected[searched] + 1)
        nowhere = np.zeros(len(again), np.int64)
        seen = replace(seen, evidence=seen.evidence + evidence, n_undetected=n_undetected, n_unseen=nowhere)
        new = detected[all_but(len(detected), paired.second)]
        born = Memory.of_new(new.r_px, new.r_std_px, self._flow.noise_um_s**2)
        hidden = self._hidden(memory, again, outcome.predicted, Droplets.concatenate([there, new]))
        waiting = memory[hidden]
        waiting = replace(waiting, n_undetected=waiting.n_undetected + 1, n_unseen=waiting.n_unseen + 1)
        together = Memory.concatenate([seen, waiting, born])
        old_ids = self._front.trajectory_id[np.concatenate([again, hidden])]
        front = Front(
            np.append(old_ids, self._next_id + np.arange(len(new))),
            Droplets.concatenate([there, unseen(outcome.predicted, hidden), new]),
            together.n_undetected == 0,
            together.n_unseen == 0,
            np.exp(together.log_r),
            np.sqrt(together.log_r_variance),
            np.concatenate([evidence, np.zeros(len(hidden) + len(new))]),
        )
        order = np.argsort(front.trajectory_id, kind="stable")
        order = order[together.n_undetected[order] <= _MOST_UNDETECTED]
        self._front, self._memory = front[order], together[order]
        self._next_id += len(new)

    def _hidden(self, memory: Memory, again: Indices, predicted: Predicted, there: Droplets) -> Indices:
        """Droplets that were not seen and may come back: well known, surely predicted, and nobody is in their place."""
        lost = all_but(len(memory.log_r), again)
        lost = lost[(memory.evidence[lost] > _SURE_EVIDENCE) & (memory.n_unseen[lost] < _MOST_UNSEEN)]
        variance = np.maximum(predicted.across_variance[lost], predicted.along_variance[lost])
        is_sure = np.sqrt(variance) < _SURE_SPACINGS * self._grid.spacing_px(len(there))
        is_inside = self._grid.contains(predicted.droplets.x_px[lost], predicted.droplets.y_px[lost])
        lost = lost[is_sure & is_inside]
        is_taken = np.isin(np.arange(len(lost)), same_droplets(predicted.droplets[lost], there, SIMILAR_RATIO).first)
        return lost[~is_taken]

    def _with_own_ways(self, memory: Memory, again: Indices, after: Droplets, outcome: Outcome, dt_s: float) -> Memory:
        """Learn what each droplet that was seen `again` does beyond flow and Stokes."""
        thought, flow = outcome.predicted.ways, outcome.flow
        if thought is None or flow is None:
            return memory
        seen = observe(
            self._motion,
            self._front.droplets[again],
            after,
            dt_s,
            log_r=memory.log_r,
            log_r_variance=memory.log_r_variance,
            weight=np.ones(len(again)),
        )
        seen = along(seen, thought[again], self._motion.up, dt_s / self._motion.pixel_size_um)
        variance = (seen.across_variance + seen.along_variance) / 2 + self._flow.noise_um_s**2 / 3
        return memory.moved(*deviations(seen, flow), variance)

    def state(self) -> Arrays:
        """Everything, as arrays."""
        return {
            **save_front("front", self._front),
            **save_columns("memory", self._memory),
            **prefixed("flow.", self._flow.state()),
            "scales": np.array([getattr(self._scales, field.name) for field in fields(Scales)]),
            "next_id": np.asarray(self._next_id),
        }

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._front = load_front("front", arrays)
        self._memory = load_columns("memory", Memory, arrays)
        self._flow.restore(without_prefix("flow.", arrays))
        self._scales = Scales(*arrays["scales"].tolist())
        self._next_id = int(arrays["next_id"])


def unseen(predicted: Predicted, which: Indices) -> Droplets:
    """Droplets where they are thought to be; nothing in the image speaks for them."""
    place = predicted.droplets[which]
    std = np.sqrt((predicted.across_variance[which] + predicted.along_variance[which]) / 2)
    nothing = np.zeros(len(which))
    r_std = predicted.log_r_std[which] * place.r_px
    return replace(place, x_std_px=std, r_std_px=np.asarray(r_std), probability=nothing, match=nothing)


def log_odds(probability: Column) -> Column:
    """ln(p / (1 - p)), as far as a single pair may convince."""
    odds = np.log(probability) - np.log(np.maximum(1 - probability, 1e-12))
    return np.asarray(np.minimum(odds, _MOST_EVIDENCE))
