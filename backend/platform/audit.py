"""Who did what: every request that changes something leaves a line, in the transaction of the change itself."""

from typing import Any

from fastapi import Request
from sqlalchemy import func
from sqlalchemy.orm import Session

from backend.models import AuditEntry
from backend.platform.identity import Identity
from backend.platform.texts import is_storable

_ABOUT = "audit"
_READING = ("GET", "HEAD", "OPTIONS")


def tell(session: Session, **about: Any) -> None:
    """Say what else belongs into the line of this request: the id of what was made, the name of what was removed."""
    session.info.setdefault(_ABOUT, {}).update({name: _plain(value) for name, value in about.items()})


def record(session: Session, request: Request) -> None:
    """Write the line of a request that changes something and succeeded; the caller's commit keeps it."""
    about = session.info.pop(_ABOUT, {})
    if request.method in _READING:
        return
    identity: Identity | None = getattr(request.state, "identity", None)
    route = request.scope.get("route")
    write(
        session,
        action=getattr(route, "name", request.method),
        about={name: _plain(value) for name, value in request.path_params.items()} | about,
        identity=identity,
        address=address_of(request),
    )


def write(session: Session, *, action: str, about: dict[str, Any], identity: Identity | None, address: str) -> None:
    """Write one line."""
    session.add(
        AuditEntry(
            at=func.now(),
            person_id=identity.person_id if identity else None,
            person_name=identity.name if identity else "nobody",
            via=(identity.via if identity else "")[:220],
            address=address,
            action=action[:100],
            about=about,
        )
    )


def address_of(request: Request) -> str:
    """Where a request comes from; behind a proxy the server must be told to believe it (--forwarded-allow-ips)."""
    return request.client.host[:60] if request.client else ""


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float):
        return value
    text = str(value)[:1000]
    return text if is_storable(text) else repr(text)[:1000]
