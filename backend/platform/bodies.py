"""Requests are bounded before they are read. The endpoints that files come to bound them themselves."""

import re
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.platform.problems import http_problem, problem_response

_UPLOAD = re.compile(r"/experiments/[^/]+/uploads(/[^/]+)?/?$")
_BYTES_TYPE = "application/offset+octet-stream"


class BoundedBodies:
    """Refuse a request that is larger than `max_bytes`, whether it says so or not."""

    def __init__(self, app: ASGIApp, *, max_bytes: int) -> None:
        self._app, self._max_bytes = app, max_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or _brings_files(scope):
            await self._app(scope, receive, send)
        elif self._announced_bytes(scope) > self._max_bytes:
            too_large = HTTPException(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            await problem_response(http_problem(too_large))(scope, receive, send)
        else:
            await self._app(scope, self._counted(receive), send)

    @staticmethod
    def _announced_bytes(scope: Scope) -> int:
        announced = Headers(scope=scope).get("content-length", "0")
        return int(announced) if announced.isdecimal() else 0

    def _counted(self, receive: Receive) -> Receive:
        n_bytes = 0

        async def counted() -> Message:
            nonlocal n_bytes
            message = await receive()
            n_bytes += len(message.get("body", b""))
            if n_bytes > self._max_bytes:
                raise HTTPException(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return message

        return counted


def _brings_files(scope: Scope) -> bool:
    """Whether what comes is the content of a file, which is never held as a whole."""
    if scope["method"] in {"POST", "PATCH"}:
        is_bytes = Headers(scope=scope).get("content-type") == _BYTES_TYPE
        return is_bytes and _UPLOAD.search(scope["path"]) is not None
    return bool(scope["method"] == "PUT")
