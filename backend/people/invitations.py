"""Invited people come in: with the account they have, or with a new one."""

from fastapi import Request, Response
from sqlalchemy.orm import Session

from backend.groups import service as groups
from backend.models import Scope
from backend.people import schemas, service, signing_in
from backend.platform.identity import Identity, NotSignedIn
from backend.platform.settings import Settings


def accept(
    session: Session,
    settings: Settings,
    request: Request,
    response: Response,
    identity: Identity | None,
    accepted: schemas.AcceptInvitation,
) -> Identity:
    """Join the group of an invitation, and be signed in."""
    invitation = groups.held(session, accepted.secret)
    if identity is None or identity.person_id is None or identity.scope is not Scope.ADMIN:
        if accepted.account is None:
            raise NotSignedIn("Sign in first, or say who you are to have an account made.")
        person = service.create(session, **accepted.account.model_dump())
        identity = signing_in.enter(session, settings, request, response, person, "invitation")
    assert identity.person_id is not None  # noqa: S101 - for the type checker: both ways above lead to a person
    groups.accept(session, invitation, identity.person_id)
    return identity
