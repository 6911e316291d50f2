"""What endpoints ask for: a transaction, whoever asks, and the parts of the running service."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import APIKeyCookie, HTTPBearer
from sqlalchemy.orm import Session

from backend.models import Right, Scope
from backend.platform.audit import address_of, record
from backend.platform.database import Sessions
from backend.platform.events import Listener
from backend.platform.identity import Identity, NotSignedIn, identify
from backend.platform.object_store import ObjectStore
from backend.platform.problems import ServiceError
from backend.platform.queue import Queue
from backend.platform.rates import Rates
from backend.platform.settings import Settings
from backend.platform.visibility import Viewer


@dataclass(frozen=True)
class Platform:
    """The parts of a running service."""

    settings: Settings
    sessions: Sessions
    store: ObjectStore
    queue: Queue
    listener: Listener
    rates: Rates


def get_platform(request: Request) -> Platform:
    """The parts that the application was started with."""
    platform: Platform = request.app.state.platform
    return platform


def get_session(request: Request, platform: Annotated[Platform, Depends(get_platform)]) -> Iterator[Session]:
    """One transaction a request, committed before the answer is sent, with the line of the audit log."""
    with platform.sessions.begin() as session:
        yield session
        record(session, request)


class NotEnough(ServiceError):
    """What they showed does not allow this, whatever it is about."""

    default_code = "forbidden"
    status = HTTPStatus.FORBIDDEN


_COOKIE = APIKeyCookie(name="dropflow", scheme_name="browser", description="After `POST /session`.", auto_error=False)
_BEARER = HTTPBearer(scheme_name="token", description="A token from the account page.", auto_error=False)
BAD_TOKENS_PER_MINUTE = 60
_SCOPE_OF_RIGHT = {
    Right.VIEW: (Scope.READ, Scope.SUBMIT, Scope.ADMIN),
    Right.EDIT: (Scope.SUBMIT, Scope.ADMIN),
    Right.MANAGE: (Scope.ADMIN,),
}


def current_identity(request: Request, platform: Annotated[Platform, Depends(get_platform)]) -> Identity | None:
    """Whoever asks, looked up in a transaction of its own: some answers last longer than one should stay open."""
    try:
        with platform.sessions.begin() as session:
            request.state.identity = identify(session, platform.settings, request)
    except NotSignedIn:
        platform.rates.count("wrong tokens", address_of(request), BAD_TOKENS_PER_MINUTE)
        raise
    identity: Identity | None = request.state.identity
    return identity


def _somebody(
    identity: Annotated[Identity | None, Depends(current_identity)],
    _cookie: Annotated[str | None, Depends(_COOKIE)],
    _bearer: Annotated[object, Depends(_BEARER)],
) -> Identity:
    if identity is None:
        raise NotSignedIn(
            "Nobody is signed in.", hint="Sign in on the page, or send a token: `Authorization: Bearer ...`."
        )
    return identity


Somebody = Annotated[Identity, Depends(_somebody)]


def _viewer(needs: Right) -> Callable[[Identity], Viewer]:
    def viewer(identity: Somebody) -> Viewer:
        if identity.scope not in _SCOPE_OF_RIGHT[needs]:
            raise NotEnough(
                f"A token to {identity.scope.value} does not allow this."
                if identity.share_id is None
                else "A shared run can only be looked at.",
                code="forbidden.scope",
                hint="Make a token of a larger scope on your account page." if identity.share_id is None else None,
            )
        return Viewer(identity.person_id, needs, identity.share_id, identity.is_administrator)

    return viewer


def _person(identity: Somebody) -> Identity:
    if identity.person_id is None or identity.scope is not Scope.ADMIN:
        raise NotEnough(
            "Only the person themselves can do this.",
            code="forbidden.account",
            hint="Sign in on the page, or use a token of the scope admin.",
        )
    return identity


def _account(identity: Annotated[Identity, Depends(_person)]) -> Viewer:
    return Viewer(identity.person_id, is_administrator=identity.is_administrator)


def _administrator(identity: Somebody) -> Identity:
    if not identity.is_administrator:
        raise NotEnough("Only an administrator of this service can do this.", code="forbidden.administrator")
    return identity


PlatformDependency = Annotated[Platform, Depends(get_platform)]
SessionDependency = Annotated[Session, Depends(get_session, scope="function")]
AnybodyDependency = Annotated[Identity | None, Depends(current_identity)]
"""Whoever asks, also if nobody is signed in."""
ViewerDependency = Annotated[Viewer, Depends(_viewer(Right.VIEW))]
"""Somebody who asks to see something."""
EditorDependency = Annotated[Viewer, Depends(_viewer(Right.EDIT))]
"""Somebody who asks to make, change or remove what belongs to a group."""
ManagerDependency = Annotated[Viewer, Depends(_viewer(Right.MANAGE))]
"""Somebody who asks to change a group itself, or who sees it."""
AccountDependency = Annotated[Viewer, Depends(_account)]
"""A person about what they are in, with all their rights."""
PersonDependency = Annotated[Identity, Depends(_person)]
"""A person about their own account."""
AdministratorDependency = Annotated[Identity, Depends(_administrator)]
"""An administrator about the service."""
