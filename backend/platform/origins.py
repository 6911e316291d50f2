"""On one machine there are no accounts, so nothing but this machine's own pages may talk to the service.

A page from elsewhere in the same browser could send requests here (or reach us under a name of its own that resolves
to this machine); its `Origin` or `Host` gives it away.
"""

from http import HTTPStatus
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from backend.platform.problems import ServiceError, problem_of, problem_response
from backend.platform.settings import is_loopback


class NotFromHere(ServiceError):
    """Another page's request."""

    default_code = "request.foreign_origin"
    status = HTTPStatus.FORBIDDEN


class LocalOnly:
    """Refuse what does not come from a page or program of this machine."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            headers = Headers(scope=scope)
            addresses = [f"//{headers.get('host', '')}", headers.get("origin", "")]
            if not all(_is_local(address) for address in addresses if address):
                error = NotFromHere("Only pages and programs of this machine may use this service.")
                await problem_response(problem_of(error))(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _is_local(address: str) -> bool:
    try:
        return is_loopback(urlsplit(address).hostname or "")
    except ValueError:
        return False
