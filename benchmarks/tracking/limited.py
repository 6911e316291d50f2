"""A computation in a process of its own, ended when it takes too long: some peers stall on dense films."""

import multiprocessing
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any


def within(limit_s: float, compute: Callable[..., Any], *given: Any) -> Any | None:
    """What `compute` returns, or None if it did not end in time; what it raises is raised here."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_report, args=(sender, compute, given))
    child.start()
    sender.close()
    try:
        if not receiver.poll(limit_s):
            return None
        answer = receiver.recv()
    finally:
        child.kill()
        child.join()
    if isinstance(answer, Exception):
        raise answer
    return answer


def _report(sender: Connection, compute: Callable[..., Any], given: tuple[Any, ...]) -> None:
    try:
        sender.send(compute(*given))
    except Exception as problem:  # whatever it is, it belongs to the caller
        sender.send(problem)
