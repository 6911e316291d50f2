"""How long work says how far it is.

A stage calls ``progress(stage, done, total)`` after every frame or so. The callback may draw a bar, renew a lease or
raise `dropflow.errors.Cancelled`; the stage lets that error through.
"""

from typing import Protocol


class Progress(Protocol):
    """Called with the stage's name, the number of frames done and their total."""

    def __call__(self, stage: str, done: int, total: int) -> None: ...


def silent(stage: str, done: int, total: int) -> None:
    """Progress for callers who do not look."""
