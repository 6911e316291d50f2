"""The one question the launcher asks its own service; no proxy of the machine is in between."""

import http.client
from contextlib import closing

from deploy.local.options import HOST


def status_of(port: int, path: str, *, timeout_s: float = 5.0) -> int | None:
    """The status of a GET; None while nobody answers."""
    with closing(http.client.HTTPConnection(HOST, port, timeout=timeout_s)) as connection:
        try:
            connection.request("GET", path)
            return connection.getresponse().status
        except (OSError, http.client.HTTPException):
            return None
