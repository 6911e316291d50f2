"""/session, /account, /invitations and /people."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import RedirectResponse

from backend.groups import service as groups
from backend.groups.errors import NoSuchInvitation
from backend.groups.schemas import ShownInvitation, Welcome
from backend.people import invitations, oidc, schemas, service, signing_in
from backend.people.errors import (
    EmailTaken,
    LastAdministrator,
    LinkSpent,
    LockedOut,
    NoProvider,
    NoSuchPerson,
    NoSuchSession,
    WrongPassword,
    WrongSignIn,
)
from backend.people.oidc import ProviderAway, ProviderRefused
from backend.people.provided import person_of
from backend.platform.audit import address_of, tell, write
from backend.platform.dependencies import (
    AdministratorDependency,
    AnybodyDependency,
    PersonDependency,
    PlatformDependency,
    SessionDependency,
)
from backend.platform.identity import ForeignOrigin, refuse_foreign_pages
from backend.platform.problems import InvalidRequest, responses
from backend.platform.rates import TooOften

session_router = APIRouter(prefix="/session", tags=["people"])
account_router = APIRouter(prefix="/account", tags=["people"])
invitations_router = APIRouter(prefix="/invitations", tags=["groups"])
people_router = APIRouter(prefix="/people", tags=["administration"])


@session_router.get("", responses=responses(ForeignOrigin, WrongSignIn, TooOften))
def session_get(
    session: SessionDependency, platform: PlatformDependency, identity: AnybodyDependency
) -> schemas.Session:
    """Tell who is signed in, and how one can. It answers everybody."""
    return signing_in.look(session, platform.settings, identity)


@session_router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses=responses(WrongSignIn, LinkSpent, ForeignOrigin, TooOften, InvalidRequest),
)
def session_create(
    request: Request,
    response: Response,
    session: SessionDependency,
    platform: PlatformDependency,
    identity: AnybodyDependency,
    said: schemas.SignIn,
) -> schemas.Session:
    """Sign in: with e-mail and password, or with a link's secret. The session is an HttpOnly cookie."""
    refuse_foreign_pages(platform.settings, request)
    per_minute = platform.settings.sign_ins_per_minute
    platform.rates.count("tries to sign in", address_of(request), per_minute)
    if said.email:
        platform.rates.count("tries to sign in", said.email, per_minute)
    if said.share is not None:
        return signing_in.look(
            session, platform.settings, signing_in.visit(session, platform.settings, response, identity, said.share)
        )
    person, came_by = signing_in.prove(session, said)
    identity = signing_in.enter(session, platform.settings, request, response, person, came_by)
    tell(session, came_by=came_by)
    return signing_in.look(session, platform.settings, identity)


@session_router.delete("", status_code=HTTPStatus.NO_CONTENT, responses=responses(ForeignOrigin, TooOften))
def session_delete(
    request: Request, response: Response, session: SessionDependency, platform: PlatformDependency
) -> None:
    """Sign out in this browser."""
    refuse_foreign_pages(platform.settings, request)
    signing_in.leave(session, platform.settings, request, response)


def _leads_here(go_on: str) -> str:
    """A path of ours, whatever was asked for: what follows our address cannot lead elsewhere."""
    is_path = go_on.startswith("/") and not go_on.startswith(("//", "/\\")) and go_on.isprintable()
    return go_on if is_path else "/"


@session_router.get(
    "/oidc",
    status_code=HTTPStatus.FOUND,
    response_class=RedirectResponse,
    responses=responses(NoProvider, ProviderAway, ProviderRefused, TooOften, InvalidRequest),
)
def session_oidc(
    request: Request,
    platform: PlatformDependency,
    go_on: Annotated[str, Query(alias="next", max_length=2000, description="Where to go on afterwards.")] = "/",
) -> RedirectResponse:
    """Send a browser to the provider of sign-ins."""
    settings = platform.settings
    if settings.oidc_issuer is None:
        raise NoProvider
    platform.rates.count("tries to sign in", address_of(request), settings.sign_ins_per_minute)
    address, cookie = oidc.begin(settings, _leads_here(go_on))
    answer = RedirectResponse(address, HTTPStatus.FOUND)
    signing_in.keep(settings, answer, oidc.COOKIE, cookie, oidc.LASTS_S)
    return answer


@session_router.get(
    "/oidc/callback",
    status_code=HTTPStatus.FOUND,
    response_class=RedirectResponse,
    responses=responses(NoProvider, ProviderRefused, ProviderAway, LockedOut, EmailTaken, TooOften, InvalidRequest),
)
def session_oidc_callback(
    request: Request,
    session: SessionDependency,
    platform: PlatformDependency,
    state: Annotated[str | None, Query(max_length=2000)] = None,
    code: Annotated[str | None, Query(max_length=4000)] = None,
) -> RedirectResponse:
    """Take a browser back from the provider, and sign its person in."""
    settings = platform.settings
    if settings.oidc_issuer is None:
        raise NoProvider
    platform.rates.count("tries to sign in", address_of(request), settings.sign_ins_per_minute)
    claims, go_on = oidc.finish(settings, request.cookies.get(oidc.COOKIE), state, code)
    answer = RedirectResponse(settings.address.rstrip("/") + _leads_here(go_on), HTTPStatus.FOUND)
    person = person_of(session, settings, claims)
    identity = signing_in.enter(session, settings, request, answer, person, schemas.Way.OIDC)
    write(session, action="session_oidc", about={}, identity=identity, address=address_of(request))
    answer.delete_cookie(oidc.COOKIE, path="/", secure=settings.is_https, httponly=True, samesite="lax")
    return answer


@account_router.get("")
def account_get(session: SessionDependency, identity: PersonDependency) -> schemas.Person:
    """Look at your account."""
    return service.shown(service.get(session, identity.person_id))


@account_router.patch("", responses=responses(InvalidRequest))
def account_update(
    session: SessionDependency, identity: PersonDependency, change: schemas.ChangeAccount
) -> schemas.Person:
    """Change your name, or whether you get e-mail."""
    return service.change_account(session, identity, change)


@account_router.put(
    "/password", status_code=HTTPStatus.NO_CONTENT, responses=responses(WrongPassword, TooOften, InvalidRequest)
)
def account_password(
    session: SessionDependency, platform: PlatformDependency, identity: PersonDependency, change: schemas.NewPassword
) -> None:
    """Take another password. Every other browser is signed out."""
    platform.rates.count("changes of a password", str(identity.person_id), platform.settings.sign_ins_per_minute)
    service.change_password(session, identity, change)


@account_router.get("/sessions")
def account_sessions(session: SessionDependency, identity: PersonDependency) -> schemas.SignedInBrowsers:
    """List the browsers in which you are signed in."""
    return schemas.SignedInBrowsers(items=service.browsers(session, identity))


@account_router.delete(
    "/sessions/{session_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchSession, InvalidRequest),
)
def account_end_session(session: SessionDependency, identity: PersonDependency, session_id: UUID) -> None:
    """Sign out in one of them."""
    service.end_browser(session, identity, session_id)


@invitations_router.post("/look", responses=responses(NoSuchInvitation, TooOften, InvalidRequest))
def invitations_look(
    request: Request, session: SessionDependency, platform: PlatformDependency, shown: ShownInvitation
) -> Welcome:
    """Tell what an invitation invites to. It answers whoever holds it."""
    platform.rates.count("invitations", address_of(request), platform.settings.sign_ins_per_minute)
    return groups.welcome(session, shown.secret)


@invitations_router.post(
    "/accept",
    responses=responses(NoSuchInvitation, EmailTaken, ForeignOrigin, WrongSignIn, TooOften, InvalidRequest),
)
def invitations_accept(
    request: Request,
    response: Response,
    session: SessionDependency,
    platform: PlatformDependency,
    identity: AnybodyDependency,
    accepted: schemas.AcceptInvitation,
) -> schemas.Session:
    """Join a group: as who is signed in, else with a new account, in which you are signed in."""
    refuse_foreign_pages(platform.settings, request)
    platform.rates.count("invitations", address_of(request), platform.settings.sign_ins_per_minute)
    joined = invitations.accept(session, platform.settings, request, response, identity, accepted)
    return signing_in.look(session, platform.settings, joined)


@people_router.get("")
def people_list(session: SessionDependency, _: AdministratorDependency) -> schemas.People:
    """List everybody who has an account. For administrators."""
    return schemas.People(items=service.everybody(session))


@people_router.post("", status_code=HTTPStatus.CREATED, responses=responses(EmailTaken, InvalidRequest))
def people_create(
    session: SessionDependency, platform: PlatformDependency, _: AdministratorDependency, new: schemas.NewPerson
) -> schemas.PersonLink:
    """Make an account. The link that is answered signs its person in once, to choose a password. For administrators."""
    return service.invite_person(session, platform.settings, new)


@people_router.patch("/{person_id}", responses=responses(NoSuchPerson, LastAdministrator, InvalidRequest))
def people_update(
    session: SessionDependency, _: AdministratorDependency, person_id: UUID, change: schemas.ChangePerson
) -> schemas.KnownPerson:
    """Make somebody an administrator, or let them in no more. For administrators."""
    return service.change_person(session, person_id, change)


@people_router.post(
    "/{person_id}/link", status_code=HTTPStatus.CREATED, responses=responses(NoSuchPerson, InvalidRequest)
)
def people_link(
    session: SessionDependency, platform: PlatformDependency, _: AdministratorDependency, person_id: UUID
) -> schemas.PersonLink:
    """Make a link that signs somebody in once, because they forgot their password. For administrators."""
    return service.make_link(session, platform.settings, service.get(session, person_id))
