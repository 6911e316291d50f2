"""In and out. A browser that signs in always gets a new session: nobody can have put one there before."""

from dataclasses import replace
from datetime import UTC, datetime

from fastapi import Request, Response
from sqlalchemy.orm import Session

from backend.groups import service as groups
from backend.models import BrowserSession, Person, Scope, ShareLink
from backend.people import passwords, repository, schemas, service
from backend.people.errors import LinkSpent, ShareExpired, WrongSignIn
from backend.platform.identity import SESSION_LASTS, Identity, session_cookie, share_cookie
from backend.platform.problems import InvalidRequest
from backend.platform.secrets import hashed, new_secret
from backend.platform.settings import Settings
from backend.platform.visibility import Viewer


def prove(session: Session, said: schemas.SignIn) -> tuple[Person, str]:
    """Who somebody is, by what they say, and by what way."""
    if said.link is not None:
        person_id = repository.use_link(session, said.link)
        person = repository.find(session, person_id) if person_id else None
        if person is None or person.disabled_at is not None:
            raise LinkSpent
        return person, schemas.Way.LINK
    if said.email is None or said.password is None:
        raise InvalidRequest("Give an e-mail address and a password, or the secret of a link.")
    person = repository.by_email(session, said.email)
    is_right = passwords.is_right(person.password_hash if person else None, said.password)
    if person is None or not is_right or person.disabled_at is not None:
        raise WrongSignIn
    if person.password_hash and passwords.is_outdated(person.password_hash):
        person.password_hash = passwords.hash_password(said.password)
    return person, schemas.Way.PASSWORD


def enter(
    session: Session, settings: Settings, request: Request, response: Response, person: Person, came_by: str
) -> Identity:
    """Sign a person in, in the browser that asks; whoever was in it before is out."""
    leave(session, settings, request, response)
    now = datetime.now(UTC)
    secret = new_secret()
    made = BrowserSession(
        person_id=person.id,
        secret_hash=hashed(secret),
        expires_at=now + SESSION_LASTS,
        used_at=now,
        browser=_printable(request.headers.get("user-agent", ""))[:300],
        came_by=came_by,
    )
    session.add(made)
    person.seen_at = now
    session.flush()
    repository.forget_expired(session, now)
    keep(settings, response, session_cookie(settings), secret, int(SESSION_LASTS.total_seconds()))
    identity = Identity(person.id, person.name, Scope.ADMIN, "session", person.is_administrator, made.id)
    request.state.identity = identity
    return identity


def visit(session: Session, settings: Settings, response: Response, identity: Identity | None, secret: str) -> Identity:
    """Let a browser look at a shared run, beside whatever its person may see."""
    link = repository.share_link(session, secret)
    if link is None:
        raise ShareExpired
    link.used_at = datetime.now(UTC)
    keep(settings, response, share_cookie(settings), secret, int((link.expires_at - link.used_at).total_seconds()))
    if identity is not None:
        return replace(identity, share_id=link.id)
    return Identity(None, "a visitor", Scope.READ, "share link", share_id=link.id)


def leave(session: Session, settings: Settings, request: Request, response: Response) -> None:
    """End the session of the browser that asks, here and there."""
    name = session_cookie(settings)
    if secret := request.cookies.get(name):
        found = repository.session_of(session, secret)
        if found is not None:
            session.delete(found)
    response.delete_cookie(name, path="/", secure=settings.is_https, httponly=True, samesite="lax")


def keep(settings: Settings, response: Response, name: str, secret: str, lasts_s: int) -> None:
    """Give the browser a cookie that no script can read, and that no page from elsewhere can send with a change."""
    response.set_cookie(
        name, secret, max_age=lasts_s, path="/", secure=settings.is_https, httponly=True, samesite="lax"
    )


def look(session: Session, settings: Settings, identity: Identity | None) -> schemas.Session:
    """Who is signed in, and how one can."""
    person = service.get(session, identity.person_id) if identity and identity.person_id else None
    viewer = Viewer(person.id if person else None)
    own = groups.shown_as(session, settings, viewer, groups.own(session, viewer)) if person else []
    shared = session.get(ShareLink, identity.share_id) if identity and identity.share_id else None
    return schemas.Session(
        person=service.shown(person) if person else None,
        groups=own,
        ways=_ways(settings),
        oidc_name=settings.oidc_name if settings.oidc_issuer else None,
        is_mailing=settings.smtp_host is not None,
        is_local=settings.auth == "local",
        shared_run_id=shared.run_id if shared else None,
    )


def _ways(settings: Settings) -> list[schemas.Way]:
    if settings.auth == "local":
        return [schemas.Way.LINK]
    return [schemas.Way.PASSWORD, *([schemas.Way.OIDC] if settings.oidc_issuer else [])]


def _printable(text: str) -> str:
    return "".join(character if character.isprintable() else "?" for character in text)
