"""Parameters that are used again."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import ForeignKey, String, UniqueConstraint, func
from sqlalchemy.orm import Mapped, mapped_column, relationship

from backend.models.base import Base, Dated, Identified, Json
from backend.models.people import Person


class Preset(Identified, Dated, Base):
    """Parameters under a name that everybody in a group finds again."""

    __tablename__ = "preset"
    __table_args__ = (UniqueConstraint("group_id", "name"),)

    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id", ondelete="CASCADE"))
    person_id: Mapped[UUID | None] = mapped_column(ForeignKey("person.id", ondelete="SET NULL"))
    """Who saved it last."""
    name: Mapped[str] = mapped_column(String(100))
    parameters: Mapped[Json]
    updated_at: Mapped[datetime] = mapped_column(server_default=func.now(), onupdate=func.now())

    person: Mapped[Person | None] = relationship()
