"""What can be done with tokens."""

from datetime import UTC, datetime, timedelta
from uuid import UUID

from sqlalchemy import func
from sqlalchemy.orm import Session

from backend.models import ApiToken
from backend.platform.audit import tell
from backend.platform.identity import Identity
from backend.platform.secrets import hashed, new_secret
from backend.tokens import repository, schemas
from backend.tokens.errors import NoSuchToken, TooManyTokens

MOST = 100
_N_SHOWN = 8


def tokens(session: Session, identity: Identity) -> list[schemas.Token]:
    """A person's tokens."""
    return [schemas.Token.model_validate(token) for token in repository.tokens(session, identity.person_id)]


def create(session: Session, identity: Identity, new: schemas.NewToken) -> schemas.MadeToken:
    """Make a token; its secret is shown now and never again."""
    if repository.n_tokens(session, identity.person_id) >= MOST:
        raise TooManyTokens(MOST)
    secret = new_secret("df_")
    token = ApiToken(
        person_id=identity.person_id,
        name=new.name,
        beginning=secret[:_N_SHOWN],
        scope=new.scope,
        secret_hash=hashed(secret),
        expires_at=datetime.now(UTC) + timedelta(days=new.days),
    )
    session.add(token)
    session.flush()
    session.refresh(token)
    tell(session, token_id=token.id, name=token.name, scope=token.scope)
    return schemas.MadeToken(**schemas.Token.model_validate(token).model_dump(), secret=secret)


def revoke(session: Session, identity: Identity, token_id: UUID) -> None:
    """Let a token in no more."""
    token = repository.find(session, identity.person_id, token_id)
    if token is None:
        raise NoSuchToken
    token.revoked_at = func.now()
    tell(session, name=token.name)
