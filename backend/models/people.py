"""Who may see what: a person is a member of groups, and every experiment belongs to a group."""

from uuid import UUID

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from backend.models.base import Base, Dated, Identified


class Person(Identified, Dated, Base):
    """Somebody who works here."""

    __tablename__ = "person"

    name: Mapped[str] = mapped_column(String(200))


class Group(Identified, Dated, Base):
    """People who share experiments."""

    __tablename__ = "group_"  # GROUP is a word of SQL

    name: Mapped[str] = mapped_column(String(200))


class Membership(Dated, Base):
    """A person sees what belongs to their groups."""

    __tablename__ = "membership"

    person_id: Mapped[UUID] = mapped_column(ForeignKey("person.id", ondelete="CASCADE"), primary_key=True)
    group_id: Mapped[UUID] = mapped_column(ForeignKey("group_.id", ondelete="CASCADE"), primary_key=True, index=True)
