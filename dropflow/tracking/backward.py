"""One step back: trajectories that begin are followed to where they came from (section 3.3.2)."""

from dataclasses import dataclass, replace

import numpy as np

from dropflow.tracking.chain import PaperChain
from dropflow.tracking.flow import FlowField, still_flow
from dropflow.tracking.follow import Look, follow
from dropflow.tracking.front import Front, Links
from dropflow.tracking.identification import Indices


@dataclass(frozen=True)
class StepBack:
    """The earlier front with trajectories enlarged and merged, and the flow between the two."""

    front: Front
    flow: FlowField
    merged: Indices
    """Ids that have become another trajectory's, in the front and in all frames before."""
    merged_into: Indices


def retreat(
    later: Front, earlier: Front, look: Look | None, chain: PaperChain, guess: FlowField | None, dt_s: float
) -> StepBack:
    """Look one frame earlier for the droplets whose trajectories begin in `later`.

    Where one meets the end of another trajectory the two are merged. Where it meets a trajectory that goes on they
    would branch: it stays where it is. Where only the image shows it, its trajectory grows by one. `guess` is the
    flow to predict with if no trajectory spans the step.
    """
    links = Links.between(earlier, later)
    heads = np.setdiff1d(np.arange(len(later)), links.later)
    tails = np.setdiff1d(np.arange(len(earlier)), links.earlier)
    flow = chain.flow_between(earlier.droplets[links.earlier], later.droplets[links.later], dt_s)
    usable = flow if flow.is_known else guess or still_flow(chain.grid)
    predicted = chain.motion.backward(later.droplets[heads], usable, dt_s)
    followed = follow(predicted, earlier.droplets[tails], earlier.droplets[links.earlier], look, chain)
    merged_tails, heads_of_merged = tails[followed.paired.second], heads[followed.paired.first]
    ids = earlier.trajectory_id.copy()
    ids[merged_tails] = later.trajectory_id[heads_of_merged]
    n_grown = len(followed.searched)
    grown = Front(later.trajectory_id[heads[followed.searched]], followed.sighted, np.zeros(n_grown, bool))
    front = Front.concatenate([replace(earlier, trajectory_id=ids), grown]).sorted()
    final = flow
    if n_grown or len(merged_tails):
        links = Links.between(front, later)
        final = chain.flow_between(front.droplets[links.earlier], later.droplets[links.later], dt_s)
    return StepBack(front, final, earlier.trajectory_id[merged_tails], later.trajectory_id[heads_of_merged])
