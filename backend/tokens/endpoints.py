"""/tokens."""

from http import HTTPStatus
from uuid import UUID

from fastapi import APIRouter

from backend.platform.dependencies import PersonDependency, SessionDependency
from backend.platform.problems import InvalidRequest, responses
from backend.tokens import service
from backend.tokens.errors import NoSuchToken, TooManyTokens
from backend.tokens.schemas import MadeToken, NewToken, Tokens

router = APIRouter(prefix="/tokens", tags=["people"])


@router.get("")
def tokens_list(session: SessionDependency, identity: PersonDependency) -> Tokens:
    """List your tokens, with when each was last used."""
    return Tokens(items=service.tokens(session, identity))


@router.post("", status_code=HTTPStatus.CREATED, responses=responses(TooManyTokens, InvalidRequest))
def tokens_create(session: SessionDependency, identity: PersonDependency, new: NewToken) -> MadeToken:
    """Make a token for a program. Its secret is shown this once: `Authorization: Bearer <secret>`."""
    return service.create(session, identity, new)


@router.delete("/{token_id}", status_code=HTTPStatus.NO_CONTENT, responses=responses(NoSuchToken, InvalidRequest))
def tokens_revoke(session: SessionDependency, identity: PersonDependency, token_id: UUID) -> None:
    """Revoke a token at once."""
    service.revoke(session, identity, token_id)
