"""The plan of a run, pure: what follows what, and which frames make a shard."""

import math
from collections.abc import Iterable
from enum import StrEnum
from itertools import pairwise

SECONDS_PER_SHARD = 20.0
"""A shard is short enough to be done again without regret and long enough that its bookkeeping does not count: 10 to
60 s, should the film be twice as quick or three times as slow as those before it."""
SECONDS_PER_MEGAPIXEL = 0.4
"""What detection is taken to need on one core until this deployment has measured it."""
MIN_SHARDS = 8
"""Short films are still divided, so that several workers take part and results appear while the run goes."""


class Task(StrEnum):
    """The kinds of work. Import and ingest of a stack belong to no run."""

    IMPORT = "import"
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


def detect_ranges(n_frames: int, seconds_per_frame: float, done: Iterable[range] = ()) -> list[range]:
    """Divide the frames of a film into consecutive ranges of some `SECONDS_PER_SHARD` of work each.

    Ranges of `done` stay as they are, so that a run finds what earlier ones have made, however those were divided;
    of two that overlap the one that begins first stays.
    """
    longest = max(1, min(int(SECONDS_PER_SHARD / max(seconds_per_frame, 1e-3)), math.ceil(n_frames / MIN_SHARDS)))
    ranges: list[range] = []
    at = 0
    for known in sorted(done, key=lambda frames: (frames.start, -frames.stop)):
        if known.start < at or known.stop > n_frames:
            continue
        ranges += [*_divided(at, known.start, longest), known]
        at = known.stop
    return [*ranges, *_divided(at, n_frames, longest)]


def _divided(start: int, stop: int, longest: int) -> list[range]:
    """Ranges of about equal length, none longer than `longest`."""
    n_parts = math.ceil((stop - start) / longest)
    edges = [start + (stop - start) * part // n_parts for part in range(n_parts)] + [stop]
    return [range(*edge) for edge in pairwise(edges)]
