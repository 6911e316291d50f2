"""Progress as bars in a terminal, with counts, rate and time left; plain lines where the output is no terminal."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from dropflow import progress as contract

_PLAIN_INTERVAL_S = 10.0


@contextmanager
def shown() -> Iterator[contract.Progress]:
    """Yield a progress callback that draws on standard error."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _PlainLines(console)
        return
    columns = (
        TextColumn("{task.description:<10}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bars:
        yield _Bars(bars)


class _Bars:
    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        if stage not in self._tasks:
            self._tasks[stage] = self._bars.add_task(stage, total=total, rate="")
        speed = self._bars.tasks[self._tasks[stage]].speed
        rate = f"{speed:.1f} frames/s" if speed else ""
        self._bars.update(self._tasks[stage], completed=done, total=total, rate=rate)


class _PlainLines:
    def __init__(self, console: Console) -> None:
        self._console = console
        self._said_s: dict[str, float] = {}

    def __call__(self, stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        if done < total and now - self._said_s.get(stage, 0.0) < _PLAIN_INTERVAL_S:
            return
        self._said_s[stage] = now
        self._console.print(f"{stage}: {done} of {total}", highlight=False)
