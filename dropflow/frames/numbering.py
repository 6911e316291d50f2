"""The numbers that cameras put into files' names, and which of them are missing."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import PurePosixPath

from dropflow.documents import StrictModel
from dropflow.frames.findings import Finding, finding


class Gap(StrictModel):
    """Frames that were taken but are not there."""

    before_frame: int
    n_missing: int


@dataclass(frozen=True)
class Numbering:
    """What the names of files, one a frame, say of their numbers."""

    gaps: tuple[Gap, ...] = ()
    findings: tuple[Finding, ...] = ()


def numbering(names: Sequence[str]) -> Numbering:
    """Find the one number that differs from name to name, and where it skips.

    The step between neighbours that is most frequent counts as one; where more than half of the steps are others, or
    one is no multiple of it, the number does not count frames, and nothing is concluded from it.
    """
    if len(names) < 2:
        return Numbering()
    numbers = _numbers(names)
    if numbers is None:
        return _unclear("differ in more than one number, or in none")
    steps = [b - a for a, b in pairwise(numbers)]
    step, n_regular = min(Counter(steps).most_common(), key=lambda item: (-item[1], item[0]))
    if step < 1 or 2 * n_regular < len(steps) or any(wrong % step for wrong in steps):
        return _unclear("do not go up in even steps")
    gaps = tuple(Gap(before_frame=at + 1, n_missing=n // step - 1) for at, n in enumerate(steps) if n > step)
    findings = [*_missing(gaps, numbers, names, step), *_wide(step)]
    return Numbering(gaps, tuple(findings))


def _numbers(names: Sequence[str]) -> list[int] | None:
    """The number of each name, None if it is not one and the same place in all of them that differs."""
    parts = [re.split(r"(\d+)", PurePosixPath(name).stem.casefold()) for name in names]
    if len({tuple(part[::2]) for part in parts}) > 1:
        return None
    numbers = [[int(digits) for digits in part[1::2]] for part in parts]
    differing = [at for at in range(len(numbers[0])) if len({row[at] for row in numbers}) > 1]
    return [row[differing[0]] for row in numbers] if len(differing) == 1 else None


def _missing(gaps: tuple[Gap, ...], numbers: list[int], names: Sequence[str], step: int) -> list[Finding]:
    n_missing = sum(gap.n_missing for gap in gaps)
    if not n_missing:
        return []
    message = (
        f"{n_missing} numbers are missing in the files' names: with frame_interval_s, time goes on over them. "
        "If no frame is missing, give timestamps."
    )
    examples = (
        f"{numbers[gap.before_frame - 1] + step} to {numbers[gap.before_frame] - step} before {names[gap.before_frame]}"
        for gap in gaps
    )
    return [finding("stack.numbers_missing", message, examples, n=n_missing)]


def _wide(step: int) -> list[Finding]:
    if step == 1:
        return []
    message = f"The files' numbers go up by {step}: one such step is taken as one frame_interval_s."
    return [finding("stack.numbers_step", message, (), n=1)]


def _unclear(reason: str) -> Numbering:
    message = f"The files' names {reason}: whether a frame is missing cannot be told. Please look at their order."
    return Numbering(findings=(finding("stack.numbers_unclear", message, (), n=1),))
