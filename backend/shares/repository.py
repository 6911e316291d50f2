"""Queries about links to runs."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from backend.models import ShareLink


def shares(session: Session, run_id: UUID) -> Sequence[ShareLink]:
    """The links of a run that work, oldest first."""
    query = select(ShareLink).where(ShareLink.run_id == run_id, ShareLink.expires_at > func.now())
    return session.scalars(query.order_by(ShareLink.created_at, ShareLink.id)).all()


def find(session: Session, run_id: UUID, share_id: UUID) -> ShareLink | None:
    """One of them."""
    return session.scalar(select(ShareLink).where(ShareLink.run_id == run_id, ShareLink.id == share_id))
