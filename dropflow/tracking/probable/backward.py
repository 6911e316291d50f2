"""One step back by probability."""

from dataclasses import replace

import numpy as np

from dropflow.parameters import Divergence
from dropflow.tracking.chain import StepBack
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.follow import Look, follow
from dropflow.tracking.front import Front, Links
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.identification import all_but
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.association import Chances, associate
from dropflow.tracking.probable.expectation import Expectation, Predicted
from dropflow.tracking.probable.flow_memory import FlowMemory
from dropflow.tracking.probable.flow_record import load_flow, save_flow
from dropflow.tracking.probable.forward import SIGHTING_EVIDENCE
from dropflow.tracking.probable.memory import Memory
from dropflow.tracking.probable.regression import WaveFlow
from dropflow.tracking.probable.search import SIMILAR_RATIO, sure_look
from dropflow.tracking.saving import prefixed, without_prefix

_WIDENING = 2.0
"""Squared errors are larger than thought by about this: a trajectory's own ways are not known at its beginning."""
_INTERRUPTED_SHARE = 0.3
"""Of the beginnings in a frame, those that are thought to go on from an end in the frame before."""


class ProbableBackward:
    """Goes back through a film."""

    def __init__(self, grid: Grid, motion: Motion, divergence: Divergence) -> None:
        self._grid = grid
        self._motion = motion
        self._flow = FlowMemory(grid, motion.up, divergence)
        self._last: WaveFlow | None = None
        """The flow of the step after, for steps of which none was found."""

    def step(
        self, later: Front, earlier: Front, look: Look | None, dt_s: float, motion: Motion, notes: Arrays
    ) -> StepBack:
        """Look one frame earlier for the droplets whose trajectories begin in `later`, in the flow found forward."""
        self._motion = motion
        links = Links.between(earlier, later)
        heads = all_but(len(later), links.later)
        tails = all_but(len(earlier), links.earlier)
        flow = self._last = load_flow(notes, motion.up) if notes else self._last
        predicted = self._expected(later[heads], flow, dt_s, self._grid.spacing_px(len(earlier)))
        ends = earlier.droplets[tails]
        density = max(len(tails), 1) / (self._grid.height_px * self._grid.width_px)
        followed = follow(
            predicted.droplets,
            associate(predicted, ends, Chances(_INTERRUPTED_SHARE, density)).pairs(),
            ends,
            taken=earlier.droplets[links.earlier],
            look=None if look is None else sure_look(look, predicted),
            similar_ratio=SIMILAR_RATIO,
        )
        merged_tails, merged_heads = tails[followed.paired.second], heads[followed.paired.first]
        ids = earlier.trajectory_id.copy()
        ids[merged_tails] = later.trajectory_id[merged_heads]
        grown = Front.of(later.trajectory_id[heads[followed.searched]], followed.sighted, is_detected=False)
        grown = replace(grown, evidence=np.full(len(grown), SIGHTING_EVIDENCE))
        front = Front.concatenate([replace(earlier, trajectory_id=ids), grown]).sorted()
        merged, into = earlier.trajectory_id[merged_tails], later.trajectory_id[merged_heads]
        arrived_px = np.zeros((2, len(later)))
        arrived_px[:, heads] = self._steps_px(later[heads], flow, dt_s)
        return StepBack(front, merged, into, self._steps_px(front, flow, dt_s), arrived_px)

    def _expected(self, begin: Front, flow: WaveFlow | None, dt_s: float, spacing_px: float) -> Predicted:
        """Where the droplets of trajectories that begin were one frame earlier."""
        noise = self._flow.noise_um_s
        memory = Memory.of_new(begin.smooth_r_px, begin.log_r_std * begin.smooth_r_px, noise**2)
        stokes_error = self._flow.stokes_error
        expectation = Expectation(self._motion, flow, 0.0, stokes_error, noise, spacing_px, _WIDENING)
        return expectation.of(begin.droplets, memory, -dt_s)

    def _steps_px(self, front: Front, flow: WaveFlow | None, dt_s: float) -> Column:
        """How far droplets should move by flow and Stokes."""
        sinking = self._motion.sinking_px(front.smooth_r_px, dt_s) * (1 + self._flow.stokes_error[0])
        if flow is None:
            return sinking
        px = dt_s / self._motion.pixel_size_um
        return np.asarray(flow.at(front.droplets.x_px, front.droplets.y_px) * px + sinking)

    def learn_from(self, arrays: Arrays) -> None:
        """Take up the model of the flow."""
        self._flow.learn_from(without_prefix("flow.", arrays))

    def state(self) -> Arrays:
        """What is known of the flow."""
        last = {} if self._last is None else save_flow(self._last)
        return {**prefixed("flow.", self._flow.state()), **prefixed("last.", last)}

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._flow.restore(without_prefix("flow.", arrays))
        last = without_prefix("last.", arrays)
        self._last = load_flow(last, self._motion.up) if last else None
