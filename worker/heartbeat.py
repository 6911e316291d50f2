"""A sign of life of each process at work: a file that holds when the process last said how far it is.

The main process of a worker looks at them. A child that neither goes on nor ends (stopped, or stuck in a call that
never returns) has lost its lease long ago, so its work is done elsewhere; but it would keep its place for ever.
The times are of the machine's monotonic clock, which all its processes share and nobody sets.
"""

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_FOLDER = "alive"


@contextmanager
def at_work(work_dir: Path) -> Iterator[Callable[[], None]]:
    """Say that this process works on something, until the context ends. What is given is to be called now and then."""
    path = work_dir / _FOLDER / f"{os.getppid()}-{os.getpid()}"

    def beat() -> None:
        with suppress(OSError):  # a full disk is no reason not to work: what is written there will say so
            path.write_text(str(time.monotonic()))

    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
    beat()
    try:
        yield beat
    finally:
        path.unlink(missing_ok=True)


def end_silent(work_dir: Path, main_process: int, longest_silence_s: float) -> list[int]:
    """Kill the children of a main process that were silent for so long; return which."""
    ended = []
    for path in (work_dir / _FOLDER).glob(f"{main_process}-*"):
        child = int(path.name.rpartition("-")[2])
        with suppress(OSError, ValueError):
            if time.monotonic() - float(path.read_text()) < longest_silence_s:
                continue
            path.unlink()
            if _parent_of(child) == main_process:
                os.kill(child, signal.SIGKILL)
                ended.append(child)
    return ended


def _parent_of(process: int) -> int | None:
    """Whose child a process is, where the system tells: a number may have been given to another since."""
    with suppress(OSError, ValueError):
        return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])
    return None
