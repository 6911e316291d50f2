"""What proves who somebody is, or lets them in. Of each secret only the SHA-256 is kept: nobody can read it here."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Identity, Index, String
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, Json, one_of
from backend.models.people import Group, Person, Right


class Scope(StrEnum):
    """What a token may be used for; each scope holds those before it."""

    READ = "read"
    SUBMIT = "submit"
    ADMIN = "admin"


class _Secret:
    """A row that is found by the hash of a secret."""

    secret_hash: Mapped[str] = mapped_column(String(64), unique=True)
    expires_at: Mapped[datetime]


class BrowserSession(Identified, Dated, _Secret, Base):
    """One browser in which a person is signed in."""

    __tablename__ = "browser_session"

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), index=True)
    browser: Mapped[str] = mapped_column(String(300))
    came_by: Mapped[str] = mapped_column(String(20))
    """`password`, `link`, `invitation` or `oidc`."""
    used_at: Mapped[datetime]

    person: Mapped[Person] = relationship(lazy="joined", innerjoin=True)


class ApiToken(Identified, Dated, _Secret, Base):
    """A program may do this for a person."""

    __tablename__ = "api_token"

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), index=True)
    name: Mapped[str] = mapped_column(String(200))
    beginning: Mapped[str] = mapped_column(String(12))
    """Its first characters, to tell it from others."""
    scope: Mapped[Scope] = mapped_column(one_of(Scope))
    used_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]

    person: Mapped[Person] = relationship(lazy="joined", innerjoin=True)


class SignInLink(Identified, Dated, _Secret, Base):
    """Whoever opens it first is this person, once: printed by `make run`, or sent to who forgot their password."""

    __tablename__ = "sign_in_link"

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"))
    used_at: Mapped[datetime | None]

    person: Mapped[Person] = relationship(lazy="joined", innerjoin=True)


class Invitation(Identified, Dated, _Secret, Base):
    """Whoever opens it may join a group with a right, once."""

    __tablename__ = "invitation"

    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id", ondelete="CASCADE"), index=True)
    right: Mapped[Right] = mapped_column(one_of(Right))
    invited_by: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="SET NULL"))
    used_at: Mapped[datetime | None]

    group: Mapped[Group] = relationship(lazy="joined", innerjoin=True)


class ShareLink(Identified, Dated, _Secret, Base):
    """Whoever opens it may look at one run, and at nothing else."""

    __tablename__ = "share_link"

    run_id: Mapped[UUID] = mapped_column(ForeignKey("run.id", ondelete="CASCADE"), index=True)
    shared_by: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="SET NULL"))
    used_at: Mapped[datetime | None]


class AuditEntry(Base):
    """Who did what; it outlives all that it speaks of."""

    __tablename__ = "audit_entry"
    __table_args__ = (Index(None, "person_id", "id"), Index(None, "action", "id"))

    id: Mapped[int] = mapped_column(BigInteger, Identity(always=True), primary_key=True)
    at: Mapped[datetime]
    person_id: Mapped[UUID | None]
    person_name: Mapped[str] = mapped_column(String(200))
    via: Mapped[str] = mapped_column(String(220))
    """`session`, or the name of the token."""
    address: Mapped[str] = mapped_column(String(60))
    action: Mapped[str] = mapped_column(String(100))
    """The operation's name in the API."""
    about: Mapped[Json]
