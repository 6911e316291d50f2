"""The plan of a run, pure: what follows what, and which frames make a shard."""

from collections.abc import Sequence
from enum import StrEnum

SECONDS_PER_SHARD = 20.0
"""A shard is short enough to be done again without regret and long enough that its bookkeeping does not count."""
SECONDS_PER_MEGAPIXEL = 0.4
"""Roughly what detection takes, on one core."""
MIN_SHARDS = 8
"""Short films are still divided, so that several workers take part and results appear while the run goes."""


class Task(StrEnum):
    """The kinds of work. The ingest of a stack belongs to no run."""

    INGEST = "ingest"
    PREPARE = "prepare"
    DETECT = "detect"
    TRACK = "track"
    ANALYSE = "analyse"


STAGE_OF_TASK = {
    Task.PREPARE: "detect",
    Task.DETECT: "detect",
    Task.TRACK: "track",
    Task.ANALYSE: "analyse",
}
"""The stage that people see; preparing is the beginning of detection."""

NEXT_TASK = {Task.PREPARE: Task.DETECT, Task.DETECT: Task.TRACK, Task.TRACK: Task.ANALYSE, Task.ANALYSE: None}
"""What begins when the last shard of a task is published."""


def detect_ranges(n_frames: int, shape: tuple[int, int]) -> Sequence[range]:
    """Divide the frames of a film into consecutive ranges of some `SECONDS_PER_SHARD` of work each.

    The same film is always divided alike, so that a later run finds the shards of an earlier one.
    """
    seconds_per_frame = max(shape[0] * shape[1] / 1e6 * SECONDS_PER_MEGAPIXEL, 1e-3)
    longest = max(1, min(int(SECONDS_PER_SHARD / seconds_per_frame), -(-n_frames // MIN_SHARDS)))
    return [range(start, min(start + longest, n_frames)) for start in range(0, n_frames, longest)]
