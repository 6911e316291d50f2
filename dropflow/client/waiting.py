"""Following something until it has ended: by the server's events, by asking again where these do not come through."""

import json
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

import httpx

from dropflow.client.connection import Connection, Json
from dropflow.client.errors import NotReachable, ServerProblem
from dropflow.errors import DropflowError

State = TypeVar("State")

ASK_EVERY_S = 1.0
EVENT_TIMEOUT_S = 45.0
"""The server says at least every 15 s that it lives."""
GIVE_UP_AFTER_S = 300.0
"""So long nobody may answer: a server is updated in less."""


class TimedOut(DropflowError, TimeoutError):
    """It was not over in the time that was given."""

    default_code = "client.timed_out"


def follow(
    connection: Connection,
    path: str,
    read: Callable[[Json], State],
    is_over: Callable[[State], bool],
    *,
    timeout_s: float | None = None,
) -> Iterator[State]:
    """What `path` shows, at once and after each change, until it is over."""
    began, away_since = time.monotonic(), None
    while True:
        try:
            for content in _events(connection, path):
                away_since = None
                yield (state := read(content))
                if is_over(state):
                    return
                _check(began, timeout_s)
        except (NotReachable, ServerProblem) as problem:
            if isinstance(problem, ServerProblem) and problem.status in (401, 403, 404):
                raise
        # The stream was cut, or never came through: a proxy may hold it back.
        try:
            yield (state := read(connection.get(path)))
            away_since = None
            if is_over(state):
                return
        except NotReachable:
            away_since = away_since or time.monotonic()
            if time.monotonic() - away_since > GIVE_UP_AFTER_S:
                raise
        _check(began, timeout_s)
        time.sleep(ASK_EVERY_S)


def _events(connection: Connection, path: str) -> Iterator[Json]:
    headers = {"Accept": "text/event-stream"}
    timeout = httpx.Timeout(EVENT_TIMEOUT_S)
    with connection.stream("GET", f"{path}/events", headers=headers, timeout=timeout) as answer:
        if not answer.headers.get("content-type", "").startswith("text/event-stream"):
            return
        for line in answer.iter_lines():
            if line.startswith("data:"):
                content = json.loads(line.removeprefix("data:"))
                if isinstance(content, dict):
                    yield content


def _check(began: float, timeout_s: float | None) -> None:
    if timeout_s is not None and time.monotonic() - began > timeout_s:
        raise TimedOut(f"It was not over after {timeout_s:g} s.", hint="It goes on there; wait for it again.")
