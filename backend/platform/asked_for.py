"""Which run or experiment a request is about: every line that is logged meanwhile names it."""

import re
import time

import structlog
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_ID = re.compile(r"/(run|experiment)s/([0-9a-f-]{36})(?=/|$)")
log = structlog.get_logger()


def asked_for(path: str) -> dict[str, str]:
    """The ids in a path, by kind."""
    return dict(_ID.findall(path))


class NamedRequests:
    """Names in each line of the log what its request is about; tells of each request at the level DEBUG.

    Never of its query: that may let somebody in.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began, status = time.perf_counter(), 500

        async def noting_send(message: Message) -> None:
            nonlocal status
            status = message.get("status", status)
            await send(message)

        with structlog.contextvars.bound_contextvars(**asked_for(scope["path"])):
            try:
                await self._app(scope, receive, noting_send)
            finally:
                took_s = round(time.perf_counter() - began, 4)
                log.debug("request", method=scope["method"], path=scope["path"], status=status, took_s=took_s)
