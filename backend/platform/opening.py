"""A service with accounts is closed until somebody looks after it: nobody signs in at one that nobody governs."""

from collections.abc import Callable
from http import HTTPStatus

from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.types import ASGIApp, Receive, Scope, Send

from backend.platform.problems import ServiceError, problem_of, problem_response

API_PATH = "/api/"
ALWAYS_OPEN = ("/api/v1/health", "/api/v1/openapi.json")


class NobodyLooksAfterIt(ServiceError):
    """There is no administrator yet."""

    default_code = "service.no_administrator"
    status = HTTPStatus.SERVICE_UNAVAILABLE


class ClosedUntilLookedAfter:
    """Answer nothing of the API but its health until `is_looked_after` says so, once."""

    def __init__(self, app: ASGIApp, *, is_looked_after: Callable[[], bool]) -> None:
        self._app, self._is_looked_after = app, is_looked_after
        self._is_open = False

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if not self._is_open and scope["type"] == "http" and _is_guarded(scope["path"]):
            try:
                self._is_open = await run_in_threadpool(self._is_looked_after)
            except SQLAlchemyError:
                await self._app(scope, receive, send)  # which says what is away
                return
            if not self._is_open:
                error = NobodyLooksAfterIt(
                    "This service is closed: nobody looks after it yet.",
                    hint="On the server: dropflow-server administrator EMAIL.",
                )
                await problem_response(problem_of(error))(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _is_guarded(path: str) -> bool:
    return path.startswith(API_PATH) and path not in ALWAYS_OPEN
