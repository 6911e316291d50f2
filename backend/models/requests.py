"""What was asked for already."""

from uuid import UUID

from sqlalchemy import ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from backend.models.base import Base, Dated


class IdempotencyKey(Dated, Base):
    """A creation that somebody named, so that asking again does not create again."""

    __tablename__ = "idempotency_key"
    __table_args__ = (Index(None, "created_at"),)

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    request_sha256: Mapped[str] = mapped_column(String(64))
    """Of the method, the address and the body."""
    made_id: Mapped[UUID | None]
    """What was created; written by the transaction that writes the row."""
