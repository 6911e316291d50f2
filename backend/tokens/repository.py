"""Queries about tokens."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from backend.models import ApiToken


def tokens(session: Session, person_id: UUID | None) -> Sequence[ApiToken]:
    """A person's tokens that were not revoked, newest first."""
    query = select(ApiToken).where(ApiToken.person_id == person_id, ApiToken.revoked_at.is_(None))
    return session.scalars(query.order_by(ApiToken.created_at.desc(), ApiToken.id)).all()


def find(session: Session, person_id: UUID | None, token_id: UUID) -> ApiToken | None:
    """One of them."""
    query = select(ApiToken).where(ApiToken.person_id == person_id, ApiToken.id == token_id)
    return session.scalar(query.where(ApiToken.revoked_at.is_(None)))


def n_tokens(session: Session, person_id: UUID | None) -> int:
    """How many there are."""
    query = select(func.count()).where(ApiToken.person_id == person_id, ApiToken.revoked_at.is_(None))
    return session.scalar(query) or 0
