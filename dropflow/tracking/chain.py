"""What a method of tracking offers to the passes over a film."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.filtering import Trails
from dropflow.tracking.flow import FlowField
from dropflow.tracking.follow import Look
from dropflow.tracking.front import Front
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.identification import Indices
from dropflow.tracking.prediction import Motion


class Walk(Protocol):
    """Something that goes through the steps of a film and can be saved between any two of them."""

    def state(self) -> Arrays:
        """All that the next step needs to know of those before."""
        ...

    def restore(self, arrays: Arrays) -> None:
        """Take up a state."""
        ...


class LaterWalk(Walk, Protocol):
    """A walk through a film that another has been through before."""

    def learn_from(self, arrays: Arrays) -> None:
        """Take from the last state of the walk before this one what holds for the whole film."""
        ...


@dataclass(frozen=True)
class StepForward:
    """Where all trajectories are, and what the way back is to know."""

    front: Front
    notes: Arrays
    """Each of shape (n,), float64. On the way back they are given for the same step."""


class ForwardWalk(Walk, Protocol):
    """From frame to frame (section 3.3.1)."""

    def step(self, detected: Droplets, look: Look | None, dt_s: float, motion: Motion) -> StepForward:
        """Go on by `dt_s` to the frame with these detections, droplets moving as `motion` says in this step."""
        ...


@dataclass(frozen=True)
class StepBack:
    """The earlier front with trajectories enlarged and merged."""

    front: Front
    merged: Indices
    """Ids that have become another trajectory's, in the front and in all frames before."""
    merged_into: Indices
    predicted_px: Column
    """Shape (2, n): how far each droplet of the front should move in the step."""
    arrived_px: Column
    """Shape (2, m): the same of those droplets of the later front whose trajectories began there."""


class BackwardWalk(LaterWalk, Protocol):
    """From frame to the frame before (section 3.3.2)."""

    def step(
        self, later: Front, earlier: Front, look: Look | None, dt_s: float, motion: Motion, notes: Arrays, /
    ) -> StepBack:
        """Look in the earlier frame, `dt_s` before, for the droplets whose trajectories begin in the later one.

        `notes` are those of the step forward.
        """
        ...


class FlowWalk(LaterWalk, Protocol):
    """The final flow field of each step. A method may need later steps to know an earlier one."""

    def add(self, before: Front, after: Front, dt_s: float, motion: Motion) -> Iterable[FlowField]:
        """Take the next step, the same trajectories before and after it; give the fields known by now, in order."""
        ...

    def finish(self) -> Iterable[FlowField]:
        """The fields of the steps not given yet."""
        ...


class Chain(Protocol):
    """A method of tracking."""

    @property
    def grid(self) -> Grid:
        """Over the frame."""
        ...

    @property
    def motion(self) -> Motion:
        """How droplets move, but for what changes along the film: see `dropflow.tracking.film.Film.motion`."""
        ...

    def forward(self) -> ForwardWalk:
        """A walk that stands before the first frame."""
        ...

    def backward(self) -> BackwardWalk:
        """A walk that stands at the last frame."""
        ...

    def flows(self) -> FlowWalk:
        """A walk that stands before the first step."""
        ...

    def judge(self, trails: Trails) -> npt.NDArray[np.str_]:
        """Why each complete trajectory is rejected; an empty word where it is kept (section 3.3.3)."""
        ...

    def settings(self) -> Any:
        """All that decides what the chain does, as a JSON document."""
        ...
