"""What is told to the outside when something happened here, and whom: the list from which it is sent until it arrived.

A notice is written in the transaction of what it tells of, so neither is there without the other.
"""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import CheckConstraint, ForeignKey, Index, String, UniqueConstraint, func
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, Json, one_of


class Event(StrEnum):
    """What can be told."""

    RUN_COMPLETED = "run.completed"
    RUN_FAILED = "run.failed"
    RUN_CANCELLED = "run.cancelled"
    TEST = "test"
    """Somebody wants to see whether notices arrive."""


class NoticeState(StrEnum):
    """How far a notice got."""

    WAITING = "waiting"
    DELIVERED = "delivered"
    FAILED = "failed"
    """Nobody took it, after all tries."""


class Webhook(Identified, Dated, Base):
    """An address elsewhere that is told what happens in a group."""

    __tablename__ = "webhook"

    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id", ondelete="CASCADE"), index=True)
    address: Mapped[str] = mapped_column(String(2000))
    events: Mapped[list[str]]
    salt: Mapped[str] = mapped_column(String(64))
    """What its secret is made from, together with the secret of the service, which is not kept here."""
    is_active: Mapped[bool] = mapped_column(default=True)


class Notice(Identified, Dated, Base):
    """One thing that happened, for one receiver: a webhook, or the mailbox of a person.

    Its id goes with every try, so that a receiver that was told twice (it took the first, and the network lost its
    answer) can see that it is the same.
    """

    __tablename__ = "notice"
    __table_args__ = (
        CheckConstraint("(webhook_id IS NULL) <> (person_id IS NULL)", name="one_receiver"),
        Index("uq_notice_of_run", "webhook_id", "run_id", "event", unique=True, postgresql_where="resend_of IS NULL"),
        UniqueConstraint("person_id", "run_id", "event"),
        Index("ix_notice_due", "due_at", postgresql_where="state = 'waiting'"),
        Index(None, "webhook_id", "created_at", "id"),
    )

    webhook_id: Mapped[UUID | None] = mapped_column(ForeignKey("webhook.id", ondelete="CASCADE"))
    person_id: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("run.id", ondelete="SET NULL"), index=True)
    event: Mapped[Event] = mapped_column(one_of(Event, "known_event"))
    about: Mapped[Json]
    """What happened, as it was at that moment."""
    resend_of: Mapped[UUID | None]
    """The notice that somebody asked to send again."""
    state: Mapped[NoticeState] = mapped_column(one_of(NoticeState), default=NoticeState.WAITING)
    n_tries: Mapped[int] = mapped_column(default=0)
    tries: Mapped[list[Json]] = mapped_column(default=list)
    """`at`, `status` of the answer, `seconds`, `problem` of each that ended."""
    due_at: Mapped[datetime] = mapped_column(server_default=func.now())
    held_until: Mapped[datetime | None]
    """Somebody is at it; after this time they are taken for dead."""

    webhook: Mapped[Webhook | None] = relationship()
