"""The paper's chain, whole."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.tracking.filtering import Trails, reasons
from dropflow.tracking.grid import Grid
from dropflow.tracking.paper.backward import PaperBackward
from dropflow.tracking.paper.flows import PaperFlows
from dropflow.tracking.paper.forward import PaperForward
from dropflow.tracking.paper.rules import PaperRules
from dropflow.tracking.prediction import Motion


@dataclass(frozen=True)
class PaperChain:
    """Prediction by flow and Stokes, closest similar droplet, average over cells."""

    rules: PaperRules

    @property
    def grid(self) -> Grid:
        """Over the frame."""
        return self.rules.grid

    @property
    def motion(self) -> Motion:
        """How droplets move."""
        return self.rules.motion

    def forward(self) -> PaperForward:
        """A walk that stands before the first frame (section 3.3.1)."""
        return PaperForward(self.rules)

    def backward(self) -> PaperBackward:
        """A walk that stands at the last frame (section 3.3.2)."""
        return PaperBackward(self.rules)

    def flows(self) -> PaperFlows:
        """The flow fields of the steps."""
        return PaperFlows(self.rules)

    def judge(self, trails: Trails) -> npt.NDArray[np.str_]:
        """Why each complete trajectory is rejected; empty where it is kept (section 3.3.3)."""
        return reasons(
            trails,
            shortest_frames=self.rules.tracking.shortest_trajectory_frames,
            stationary_fraction=self.rules.tracking.paper.stationary_fraction,
            frame_px=(self.rules.grid.height_px, self.rules.grid.width_px),
        )

    def settings(self) -> Any:
        """All that decides what the chain does."""
        return [self.rules.tracking.model_dump(mode="json"), self.rules.flow.model_dump(mode="json")]
