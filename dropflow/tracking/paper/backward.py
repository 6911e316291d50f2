"""One step back: trajectories that begin are followed to where they came from (section 3.3.2)."""

from dataclasses import replace

from dropflow.tracking.chain import StepBack
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.flow import FlowField, still_flow
from dropflow.tracking.follow import Look, follow
from dropflow.tracking.front import Front, Links
from dropflow.tracking.identification import all_but
from dropflow.tracking.paper.rules import PaperRules
from dropflow.tracking.prediction import Motion
from dropflow.tracking.saving import load_flow, save_flow


class PaperBackward:
    """Goes back through a film."""

    def __init__(self, rules: PaperRules) -> None:
        self._rules = rules
        self._flow: FlowField | None = None

    def step(
        self, later: Front, earlier: Front, look: Look | None, dt_s: float, motion: Motion, _notes: Arrays
    ) -> StepBack:
        """Look one frame earlier for the droplets whose trajectories begin in `later`."""
        step, flow = retreat(later, earlier, look, replace(self._rules, motion=motion), self._flow, dt_s)
        self._flow = flow if flow.is_known else self._flow
        return step

    def learn_from(self, arrays: Arrays) -> None:
        """The paper has nothing that holds for the whole film."""

    def state(self) -> Arrays:
        """The last flow that was known."""
        return save_flow("flow", self._flow)

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._flow = load_flow("flow", arrays, self._rules.grid)


def retreat(
    later: Front, earlier: Front, look: Look | None, rules: PaperRules, guess: FlowField | None, dt_s: float
) -> tuple[StepBack, FlowField]:
    """Look one frame earlier for the droplets whose trajectories begin in `later`.

    Where one meets the end of another trajectory the two are merged. Where it meets a trajectory that goes on they
    would branch: it stays where it is. Where only the image shows it, its trajectory grows by one. `guess` is the
    flow to predict with if no trajectory spans the step. Returns also the flow of the step.
    """
    links = Links.between(earlier, later)
    heads = all_but(len(later), links.later)
    tails = all_but(len(earlier), links.earlier)
    flow = rules.flow_between(earlier.droplets[links.earlier], later.droplets[links.later], dt_s)
    usable = flow if flow.is_known else guess or still_flow(rules.grid)
    predicted = rules.motion.backward(later.droplets[heads], usable, dt_s)
    ends, others = earlier.droplets[tails], earlier.droplets[links.earlier]
    paired = rules.pair(predicted, ends, spacing_px=rules.grid.spacing_px(len(earlier)))
    followed = follow(predicted, paired, ends, taken=others, look=look, similar_ratio=rules.similar_ratio)
    merged_tails, heads_of_merged = tails[followed.paired.second], heads[followed.paired.first]
    ids = earlier.trajectory_id.copy()
    ids[merged_tails] = later.trajectory_id[heads_of_merged]
    n_grown = len(followed.searched)
    grown = Front.of(later.trajectory_id[heads[followed.searched]], followed.sighted, is_detected=False)
    front = Front.concatenate([replace(earlier, trajectory_id=ids), grown]).sorted()
    final = flow
    if n_grown or len(merged_tails):
        links = Links.between(front, later)
        final = rules.flow_between(front.droplets[links.earlier], later.droplets[links.later], dt_s)
    predicted_px, arrived_px = (rules.motion.step_px(one.droplets, final, dt_s) for one in (front, later))
    merged_into = later.trajectory_id[heads_of_merged]
    return StepBack(front, earlier.trajectory_id[merged_tails], merged_into, predicted_px, arrived_px), final
