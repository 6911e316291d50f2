"""One step forward: every droplet to its place in the next frame (sections 3.2.1 and 3.3.1)."""

from dataclasses import dataclass, replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.chain import StepForward
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.first_flow import elect_pairs
from dropflow.tracking.flow import FlowField, still_flow
from dropflow.tracking.follow import Followed, Look, follow
from dropflow.tracking.front import Front
from dropflow.tracking.identification import Pairs, all_but
from dropflow.tracking.paper.rules import PaperRules
from dropflow.tracking.prediction import Motion, moved
from dropflow.tracking.saving import load_flow, load_front, save_flow, save_front

_MOST_ROUNDS = 8
"""Of identifying and averaging again, when the flow had to be found from nothing."""
_LOST_SHARE = 0.3
"""When fewer of the droplets than this find their image, the guess of the flow is no good."""


@dataclass(frozen=True)
class State:
    """All that forward tracking knows when it stands at a frame."""

    front: Front
    flow: FlowField | None
    """Of the last step in which a droplet was followed."""
    next_id: int

    @staticmethod
    def initial() -> "State":
        """Before the first frame."""
        return State(Front.empty(), None, 0)


class PaperForward:
    """Goes forward through a film."""

    def __init__(self, rules: PaperRules) -> None:
        self._rules = rules
        self._state = State.initial()

    def step(self, detected: Droplets, look: Look | None, dt_s: float, motion: Motion) -> StepForward:
        """Go on to the frame with these detections."""
        self._state = advance(self._state, detected, look, replace(self._rules, motion=motion), dt_s)
        return StepForward(self._state.front, {})

    def state(self) -> Arrays:
        """Where the trajectories are, and the flow there."""
        return {
            **save_front("front", self._state.front),
            **save_flow("flow", self._state.flow),
            "next_id": np.asarray(self._state.next_id),
        }

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        flow = load_flow("flow", arrays, self._rules.grid)
        self._state = State(load_front("front", arrays), flow, int(arrays["next_id"]))


def advance(state: State, detected: Droplets, look: Look | None, rules: PaperRules, dt_s: float) -> State:
    """Follow all droplets of the front into the next frame, where `detected` were found.

    The flow of the step before predicts, the closest similar droplets give the flow of this step, and that predicts
    again; droplets still missing are looked for in the image. Detections that nobody claims begin trajectories.
    """
    droplets = state.front.droplets
    flow = _flow_of_step(droplets, detected, state.flow, rules, dt_s)
    predicted = rules.motion.forward(droplets, flow or still_flow(rules.grid), dt_s)
    paired = rules.pair(predicted, detected, spacing_px=rules.grid.spacing_px(len(detected)))
    followed = follow(predicted, paired, detected, taken=Droplets.empty(), look=look, similar_ratio=rules.similar_ratio)
    front = _continue(state, detected, followed)
    before = droplets[np.concatenate([followed.paired.first, followed.searched])]
    after = Droplets.concatenate([detected[followed.paired.second], followed.sighted])
    final = rules.flow_between(before, after, dt_s)
    n_new = len(detected) - len(followed.paired)
    return State(front, final if final.is_known else flow, state.next_id + n_new)


def _continue(state: State, detected: Droplets, followed: Followed) -> Front:
    ids = state.front.trajectory_id
    paired, searched = followed.paired, followed.searched
    unclaimed = all_but(len(detected), paired.second)
    new_ids = state.next_id + np.arange(len(unclaimed))
    parts = [
        Front.of(ids[paired.first], detected[paired.second], is_detected=True),
        Front.of(ids[searched], followed.sighted, is_detected=False),
        Front.of(new_ids, detected[unclaimed], is_detected=True),
    ]
    return Front.concatenate(parts).sorted()


def _flow_of_step(
    droplets: Droplets, detected: Droplets, guess: FlowField | None, rules: PaperRules, dt_s: float
) -> FlowField | None:
    """The flow that explains where the droplets went, or the guess when none of them was found again."""
    if guess is not None:
        pairs = _identify(droplets, detected, guess, rules, dt_s)
        if len(pairs) >= _LOST_SHARE * min(len(droplets), len(detected)):
            return _flow_of(pairs, droplets, detected, rules, dt_s) or guess
    found = _flow_from_nothing(droplets, detected, rules, dt_s)
    if guess is not None and found is not None:
        again = _identify(droplets, detected, found, rules, dt_s)
        return found if len(again) > len(pairs) else _flow_of(pairs, droplets, detected, rules, dt_s) or guess
    return found or guess


def _flow_from_nothing(droplets: Droplets, detected: Droplets, rules: PaperRules, dt_s: float) -> FlowField | None:
    """Elect displacements, then identify and average until the pairs stay the same."""
    sunk = moved(droplets, rules.motion.sinking_px(droplets.r_px, dt_s))
    spacing_px = rules.grid.spacing_px(len(detected))
    pairs = elect_pairs(sunk, detected, spacing_px=spacing_px)
    flow = _flow_of(pairs, droplets, detected, rules, dt_s)
    for _ in range(_MOST_ROUNDS):
        again = _identify(droplets, detected, flow or still_flow(rules.grid), rules, dt_s)
        if np.array_equal(again.first, pairs.first) and np.array_equal(again.second, pairs.second):
            break
        pairs, flow = again, _flow_of(again, droplets, detected, rules, dt_s)
    return flow


def _identify(droplets: Droplets, detected: Droplets, flow: FlowField, rules: PaperRules, dt_s: float) -> Pairs:
    predicted = rules.motion.forward(droplets, flow, dt_s)
    return rules.pair(predicted, detected, spacing_px=rules.grid.spacing_px(len(detected)))


def _flow_of(pairs: Pairs, droplets: Droplets, detected: Droplets, rules: PaperRules, dt_s: float) -> FlowField | None:
    """Flow field from pairs, if there are any."""
    if not len(pairs):
        return None
    return rules.flow_between(droplets[pairs.first], detected[pairs.second], dt_s)
