"""A server waits for open connections before it tells the application of its end, and live streams never close.

So the signal that stops the server tells the streams first, then the server.
"""

import asyncio
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def before_stopping(let_go: Callable[[], None]) -> Iterator[None]:
    """Call `let_go` on the running loop when this process is told to stop, before whoever handles that signal does."""
    if threading.current_thread() is not threading.main_thread():
        yield  # a server in a thread gets no signals
        return
    loop = asyncio.get_running_loop()
    handlers: dict[int, Any] = {number: signal.getsignal(number) for number in _SIGNALS}

    def handle(number: int, frame: FrameType | None) -> None:
        loop.call_soon_threadsafe(let_go)
        if callable(handlers[number]):
            handlers[number](number, frame)

    for number in _SIGNALS:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number in _SIGNALS:
            signal.signal(number, handlers[number])
