"""Queries about presets. Who may see the group was decided before."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session, joinedload

from backend.models import Group, Preset


def presets(session: Session, group: Group) -> Sequence[Preset]:
    """All of a group, by name."""
    query = select(Preset).options(joinedload(Preset.person)).where(Preset.group_id == group.id)
    return session.scalars(query.order_by(func.lower(Preset.name), Preset.name)).all()


def find(session: Session, group: Group, preset_id: UUID) -> Preset | None:
    """One of them."""
    return session.scalar(select(Preset).where(Preset.group_id == group.id, Preset.id == preset_id))


def by_name(session: Session, group: Group, name: str) -> Preset | None:
    """The one of this name."""
    return session.scalar(select(Preset).where(Preset.group_id == group.id, Preset.name == name))


def n_presets(session: Session, group: Group) -> int:
    """How many a group has."""
    return session.scalar(select(func.count()).where(Preset.group_id == group.id)) or 0
