"""Tracking by probability, whole."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.parameters import Divergence, TrackingParameters
from dropflow.tracking.filtering import Trails, reasons
from dropflow.tracking.grid import Grid
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.backward import ProbableBackward
from dropflow.tracking.probable.flows import ProbableFlows
from dropflow.tracking.probable.forward import ProbableForward

_STATIONARY_FRACTION = 0.25
_LEAST_EVIDENCE = 6.5
"""ln odds of a trajectory against chance: with it fewer than 1 in 100 random detections get into one."""

_SURE_PAIR_EVIDENCE = 8.0
"""ln odds of a single pair that needs no third frame to be believed."""


@dataclass(frozen=True)
class ProbableChain:
    """Predictions with their errors, one assignment a frame, the flow by regression."""

    grid: Grid
    motion: Motion
    tracking: TrackingParameters
    divergence: Divergence

    def forward(self) -> ProbableForward:
        """A walk that stands before the first frame."""
        return ProbableForward(self.grid, self.motion, self.divergence)

    def backward(self) -> ProbableBackward:
        """A walk that stands at the last frame."""
        return ProbableBackward(self.grid, self.motion, self.divergence)

    def flows(self) -> ProbableFlows:
        """The flow fields of the steps."""
        return ProbableFlows(self.grid, self.motion, self.divergence)

    def judge(self, trails: Trails) -> npt.NDArray[np.str_]:
        """Why each complete trajectory is rejected; empty where it is kept."""
        return reasons(
            trails,
            shortest_frames=self.tracking.shortest_trajectory_frames,
            stationary_fraction=_STATIONARY_FRACTION,
            least_evidence=_LEAST_EVIDENCE,
            sure_pair_evidence=_SURE_PAIR_EVIDENCE,
            frame_px=(self.grid.height_px, self.grid.width_px),
        )

    def settings(self) -> Any:
        """All that decides what the chain does."""
        return ["probable", self.tracking.shortest_trajectory_frames, str(self.divergence)]
