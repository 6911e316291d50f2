"""Ctrl-C and its kin: the first asks for an orderly end, the second for an immediate one."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

ASKING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class StopRequested(BaseException):
    """Not an error; nothing but the end of the program catches it."""


@contextmanager
def stop_on_signals() -> Iterator[None]:
    """Within the context each signal that asks to stop raises `StopRequested` in the main thread."""
    before = {number: signal.signal(number, _raise) for number in ASKING}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _raise(_number: int, _frame: FrameType | None) -> None:
    raise StopRequested
