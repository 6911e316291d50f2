"""Server-sent events: the state of something now, again whenever it changed, and never a session held meanwhile."""

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import TypeVar

from fastapi.concurrency import run_in_threadpool
from fastapi.sse import ServerSentEvent
from pydantic import BaseModel

from backend.platform.events import Listener
from backend.platform.problems import NotFound

SHORTEST_PAUSE_S = 0.5
LONGEST_PAUSE_S = 15.0

Changes = AsyncIterator[ServerSentEvent]
Shown = TypeVar("Shown", bound=BaseModel)


def _never(_: object) -> bool:
    return False


async def follow(
    listener: Listener,
    topic: str,
    look: Callable[[], Shown],
    is_final: Callable[[Shown], bool] = _never,
) -> Changes:
    """`changed` with what `look` returns: at once, then after changes, at most twice a second, until it is final.

    Should word of a change ever be lost, the look after the longest pause finds it.
    """
    shown = ""
    with listener.subscription(topic) as woken:
        while not listener.is_stopping:
            woken.clear()
            try:
                now = await run_in_threadpool(look)
            except NotFound:
                return  # it was deleted
            if (content := now.model_dump_json()) != shown:
                shown = content
                yield ServerSentEvent(event="changed", raw_data=content)
            if is_final(now):
                return
            await asyncio.sleep(SHORTEST_PAUSE_S)
            await _wait(woken, LONGEST_PAUSE_S)


async def _wait(woken: asyncio.Event, timeout_s: float) -> None:
    try:
        await asyncio.wait_for(woken.wait(), timeout_s)
    except TimeoutError:
        return
