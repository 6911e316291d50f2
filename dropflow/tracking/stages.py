"""What the three passes over a film have in common: they go part by part, and their state can be saved."""

from collections.abc import Callable
from typing import Protocol

from dropflow.tracking.checkpoint import Arrays

Tick = Callable[[], None]
"""Called after each frame."""


class Stage(Protocol):
    """A pass over the film. `run` of the parts in order, from a state restored after any of them, gives the same."""

    @property
    def name(self) -> str:
        """Unlike that of every other stage."""
        ...

    @property
    def n_parts(self) -> int:
        """How often `run` is to be called."""
        ...

    def n_frames_of(self, turn: int) -> int:
        """How many frames that call will walk through."""
        ...

    def begin(self, before: Arrays) -> None:
        """Take what is of use from the last state of the stage before this one."""
        ...

    def run(self, turn: int, tick: Tick) -> None:
        """Do the part whose turn it is (0 comes first, whichever part of the film that is) and write what it gives."""
        ...

    def state(self) -> Arrays:
        """All that the next turn needs and is not in files."""
        ...

    def restore(self, arrays: Arrays) -> None:
        """Take up a state."""
        ...
