"""Progress as bars in a terminal, with counts, rate and time left; plain lines where the output is no terminal."""

import time
from collections.abc import Iterator, Set
from contextlib import contextmanager
from math import ceil, inf

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from dropflow import progress as contract

_PLAIN_INTERVAL_S = 10.0


_MEGABYTE = 1e6


@contextmanager
def shown(*, in_bytes: Set[str] | None = frozenset()) -> Iterator[contract.Progress]:
    """Yield a progress callback that draws on standard error.

    Stages count frames; those of `in_bytes` (None: all) count bytes, which are shown as MB.
    """
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Scaled(_PlainLines(console), in_bytes)
        return
    columns = (
        TextColumn("{task.description:<10}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bars:
        yield _Scaled(_Bars(bars), in_bytes)


class _Scaled:
    """Shows what is counted in bytes as MB."""

    def __init__(self, shown: contract.Progress, in_bytes: Set[str] | None) -> None:
        self._shown, self._in_bytes = shown, in_bytes

    def __call__(self, stage: str, done: int, total: int) -> None:
        if self._in_bytes is not None and stage not in self._in_bytes:
            self._shown(stage, done, total)
        else:
            n_left = ceil((total - done) / _MEGABYTE)
            n_all = max(1, ceil(total / _MEGABYTE))
            self._shown(f"{stage}, MB", n_all - n_left, n_all)


class _Bars:
    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage not in self._tasks:
            self._tasks[stage] = self._bars.add_task(stage, total=total, rate="")
        speed = self._bars.tasks[self._tasks[stage]].speed
        unit = "MB/s" if stage.endswith(", MB") else "frames/s"
        rate = f"{speed:.1f} {unit}" if speed else ""
        self._bars.update(self._tasks[stage], completed=done, total=total, rate=rate)


class _PlainLines:
    def __init__(self, console: Console) -> None:
        self._console = console
        self._said_s: dict[str, float] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        now, said_s = time.monotonic(), self._said_s.get(stage, 0.0)
        if said_s == inf or (done < total and now - said_s < _PLAIN_INTERVAL_S):
            return
        self._said_s[stage] = inf if done == total else now  # the end is said once
        self._console.print(f"{stage}: {done} of {total}", highlight=False)
