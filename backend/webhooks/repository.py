"""Queries about webhooks and what they were told."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from backend.models import Notice, Webhook
from backend.platform.pages import Order, page_of
from backend.webhooks.schemas import NoticeQuery


def webhooks(session: Session, group_id: UUID) -> Sequence[Webhook]:
    """The webhooks of a group, oldest first."""
    query = select(Webhook).where(Webhook.group_id == group_id).order_by(Webhook.created_at, Webhook.id)
    return session.scalars(query).all()


def n_webhooks(session: Session, group_id: UUID) -> int:
    """How many there are."""
    return session.scalar(select(func.count()).where(Webhook.group_id == group_id)) or 0


def find(session: Session, group_id: UUID, webhook_id: UUID) -> Webhook | None:
    """One of them."""
    return session.scalar(select(Webhook).where(Webhook.group_id == group_id, Webhook.id == webhook_id))


def notices(session: Session, webhook_id: UUID, query: NoticeQuery) -> tuple[Sequence[Notice], str | None]:
    """One page of what a webhook was told, newest first."""
    asked = select(Notice).where(Notice.webhook_id == webhook_id)
    if query.state is not None:
        asked = asked.where(Notice.state == query.state)
    keys = (Notice.created_at.expression, Notice.id.expression)
    return page_of(
        session, asked, Order("-created_at", keys, is_descending=True), limit=query.limit, cursor=query.cursor
    )


def notice(session: Session, webhook_id: UUID, notice_id: UUID) -> Notice | None:
    """One of these."""
    return session.scalar(select(Notice).where(Notice.webhook_id == webhook_id, Notice.id == notice_id))
