"""On one machine there are no accounts, so nothing but this machine's own pages may talk to the service.

A page from elsewhere in the same browser could send requests here (or reach us under a name of its own that resolves
to this machine); its `Origin` or `Host` gives it away. A program on another machine can write there what it likes:
where its connection came in gives that one away, in case somebody has the server listen to all the world by hand.
"""

from collections.abc import Mapping, Sequence
from http import HTTPStatus
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from backend.platform.loopback import is_loopback
from backend.platform.problems import ServiceError, problem_of, problem_response


class NotFromHere(ServiceError):
    """Another page's request."""

    default_code = "request.foreign_origin"
    status = HTTPStatus.FORBIDDEN


class OpenDoor(ValueError):
    """The server was told to listen to all the world, and would let everybody in."""


def refuse_open_door(arguments: Sequence[str], environment: Mapping[str, str]) -> None:
    """Refuse to start where uvicorn is told to listen elsewhere than on this machine. Raises `OpenDoor`."""
    hosts = [environment.get("UVICORN_HOST", "")]
    for argument, following in zip(arguments, [*arguments[1:], ""], strict=False):
        name, _, value = argument.partition("=")
        if name == "--host":
            hosts.append(value or following)
    for host in hosts:
        if host and not is_loopback(host):
            raise OpenDoor(
                f"without accounts (AUTH=local) nobody but this machine may reach the service, and --host {host} would "
                "let everybody; set AUTH=accounts, SECRET and PUBLIC_URL"
            )


class LocalOnly:
    """Refuse what does not come from a page or program of this machine."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            headers = Headers(scope=scope)
            addresses = [f"//{headers.get('host', '')}", headers.get("origin", "")]
            came_in, port = scope.get("server") or ("", None)
            is_inside = port is None or is_loopback(came_in)  # without a port it is a socket in the file system
            if not is_inside or not all(_is_local(address) for address in addresses if address):
                error = NotFromHere("Only pages and programs of this machine may use this service.")
                await problem_response(problem_of(error))(scope, receive, send)
                return
        await self._app(scope, receive, send)


def _is_local(address: str) -> bool:
    try:
        return is_loopback(urlsplit(address).hostname or "")
    except ValueError:
        return False
