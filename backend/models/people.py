"""Who may see what: a person is a member of groups with a right, and every experiment belongs to a group."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, one_of


class Right(StrEnum):
    """What a member may do with what belongs to a group; each right holds those before it."""

    VIEW = "view"
    EDIT = "edit"
    MANAGE = "manage"


def at_least(right: Right) -> tuple[Right, ...]:
    """The rights that hold `right`."""
    rights = tuple(Right)
    return rights[rights.index(right) :]


class Person(Identified, Dated, Base):
    """Somebody who works here. Without a password they sign in elsewhere (OIDC), or not at all."""

    __tablename__ = "person"
    __table_args__ = (UniqueConstraint("oidc_issuer", "oidc_subject"),)

    name: Mapped[str] = mapped_column(String(200))
    email: Mapped[str | None] = mapped_column(String(320), unique=True)
    """In lower case."""
    password_hash: Mapped[str | None] = mapped_column(String(200))
    oidc_issuer: Mapped[str | None] = mapped_column(String(300))
    oidc_subject: Mapped[str | None] = mapped_column(String(300))
    is_administrator: Mapped[bool] = mapped_column(default=False)
    is_mailed: Mapped[bool] = mapped_column(default=True)
    """Whether they want e-mail about the runs that they started."""
    disabled_at: Mapped[datetime | None]
    """From then on they can do and see nothing; what they made stays."""
    seen_at: Mapped[datetime | None]


class Group(Identified, Dated, Base):
    """People who share experiments; or the space of one person, which nobody else joins."""

    __tablename__ = "group_"  # GROUP is a word of SQL

    name: Mapped[str] = mapped_column(String(200))
    personal_of: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), unique=True)
    max_bytes: Mapped[int | None] = mapped_column(BigInteger)
    """Room for frames and results; None: what the service's settings say."""
    max_active_runs: Mapped[int | None]
    """Runs that are queued or running at once; None: what the service's settings say."""


class Membership(Dated, Base):
    """A person sees what belongs to their groups."""

    __tablename__ = "membership"

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), primary_key=True)
    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id", ondelete="CASCADE"), primary_key=True, index=True)
    right: Mapped[Right] = mapped_column(one_of(Right), default=Right.MANAGE)

    person: Mapped[Person] = relationship()
    group: Mapped[Group] = relationship()
