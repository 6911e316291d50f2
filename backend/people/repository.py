"""Queries about people and groups."""

from collections.abc import Sequence

from sqlalchemy.orm import Session

from backend.models import Group
from backend.platform.visibility import Viewer, visible_groups


def groups(session: Session, viewer: Viewer) -> Sequence[Group]:
    """The groups of this person, oldest first."""
    return session.scalars(visible_groups(viewer).order_by(Group.created_at, Group.id)).all()
