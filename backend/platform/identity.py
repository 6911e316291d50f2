"""Who asks: a browser by its cookie, a program by its token, a visitor by a link, or the one person of a machine."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from http import HTTPStatus
from urllib.parse import urlsplit
from uuid import UUID

from fastapi import Request
from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from backend.models import ApiToken, BrowserSession, Person, Scope, ShareLink
from backend.platform.problems import ServiceError
from backend.platform.secrets import hashed
from backend.platform.settings import Settings
from backend.platform.visibility import LOCAL_VIEWER

SESSION_LASTS = timedelta(days=30)
_TELL_USE_EVERY = timedelta(minutes=1)
_SAFE_METHODS = ("GET", "HEAD", "OPTIONS")
_OWN_FETCHES = ("same-origin", "none")


class NotSignedIn(ServiceError):
    """Nobody, or somebody whose proof does not hold."""

    default_code = "session.none"
    status = HTTPStatus.UNAUTHORIZED


class ForeignOrigin(ServiceError):
    """A page from elsewhere makes this browser ask."""

    default_code = "request.foreign_origin"
    status = HTTPStatus.FORBIDDEN


@dataclass(frozen=True)
class Identity:
    """Whoever asks, as what they showed proves it."""

    person_id: UUID | None
    name: str
    scope: Scope
    via: str
    is_administrator: bool = False
    session_id: UUID | None = None
    share_id: UUID | None = None


LOCAL_IDENTITY = Identity(LOCAL_VIEWER.person_id, "You", Scope.ADMIN, "local", is_administrator=True)


def session_cookie(settings: Settings) -> str:
    """Name of the cookie: cookies do not tell ports apart, and one machine may run several services."""
    if settings.auth == "local":
        return f"dropflow_{settings.port}"
    return "__Host-dropflow" if settings.is_https else "dropflow"


def share_cookie(settings: Settings) -> str:
    """The same, for the link that a visitor came by."""
    return session_cookie(settings) + "_share"


def identify(session: Session, settings: Settings, request: Request) -> Identity | None:
    """Whoever asks; None is nobody. A token or cookie that does not hold is an error or nobody, never somebody else."""
    token = _token(request)
    if token is not None:
        return _by_token(session, token)
    share_id = _share(session, request.cookies.get(share_cookie(settings)))
    found = _by_cookie(session, request.cookies.get(session_cookie(settings)), share_id)
    if found is None and share_id is not None:
        found = Identity(None, "a visitor", Scope.READ, "share link", share_id=share_id)
    if found is not None:
        refuse_foreign_pages(settings, request)
    if found is None and settings.is_open:
        return LOCAL_IDENTITY
    return found


def refuse_foreign_pages(settings: Settings, request: Request) -> None:
    """A browser sends cookies whoever's page asks; it also says whose page that is, which a page cannot forge."""
    if request.method in _SAFE_METHODS or _token(request) is not None:
        return  # a page from elsewhere cannot send a token without being asked for it first, and we never allow that
    origin, fetched = request.headers.get("origin"), request.headers.get("sec-fetch-site")
    is_own = fetched in _OWN_FETCHES if origin is None else _is_own(settings, request, origin)
    if not is_own:
        raise ForeignOrigin(
            "This was asked by a page from elsewhere, or by a program that uses a browser's cookie.",
            hint="Programs use a token: `Authorization: Bearer ...`.",
        )


def _token(request: Request) -> str | None:
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else None


def _is_own(settings: Settings, request: Request, origin: str) -> bool:
    return origin in settings.origins or urlsplit(origin).netloc == request.headers.get("host")


def _by_token(session: Session, secret: str) -> Identity:
    token = session.scalar(select(ApiToken).where(ApiToken.secret_hash == hashed(secret)))
    if token is None or token.revoked_at is not None or token.person.disabled_at is not None:
        raise NotSignedIn("This token is not known here, or was revoked.", code="token.unknown")
    now = datetime.now(UTC)
    if token.expires_at < now:
        raise NotSignedIn(f"This token expired on {token.expires_at:%Y-%m-%d}.", code="token.expired")
    if token.used_at is None or now - token.used_at > _TELL_USE_EVERY:
        session.execute(update(ApiToken).where(ApiToken.id == token.id).values(used_at=func.now()))
    return _identity(token.person, token.scope, f"token {token.name}")


def _by_cookie(session: Session, secret: str | None, share_id: UUID | None) -> Identity | None:
    if secret is None:
        return None
    found = session.scalar(select(BrowserSession).where(BrowserSession.secret_hash == hashed(secret)))
    now = datetime.now(UTC)
    if found is None or found.expires_at < now or found.person.disabled_at is not None:
        return None
    if now - found.used_at > _TELL_USE_EVERY:
        used = {"used_at": now, "expires_at": now + SESSION_LASTS}
        session.execute(update(BrowserSession).where(BrowserSession.id == found.id).values(used))
        session.execute(update(Person).where(Person.id == found.person_id).values(seen_at=now))
    return _identity(found.person, Scope.ADMIN, "session", found.id, share_id)


def _identity(
    person: Person, scope: Scope, via: str, session_id: UUID | None = None, share_id: UUID | None = None
) -> Identity:
    is_administrator = person.is_administrator and scope is Scope.ADMIN
    return Identity(person.id, person.name, scope, via, is_administrator, session_id, share_id)


def _share(session: Session, secret: str | None) -> UUID | None:
    if secret is None:
        return None
    query = select(ShareLink.id).where(ShareLink.secret_hash == hashed(secret), ShareLink.expires_at > func.now())
    return session.scalar(query)
