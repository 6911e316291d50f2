"""Queries about groups, their members and invitations."""

from collections.abc import Mapping, Sequence
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session, joinedload

from backend.models import Experiment, Group, Invitation, Membership, Right
from backend.platform.secrets import hashed
from backend.platform.visibility import Viewer, governed_groups, visible_groups

_OWN_FIRST = (Group.personal_of.is_(None), Group.created_at, Group.id)


def groups(session: Session, viewer: Viewer) -> Sequence[Group]:
    """The groups of this person, their own space first."""
    return session.scalars(visible_groups(viewer).order_by(*_OWN_FIRST)).all()


def governed(session: Session, viewer: Viewer) -> Sequence[Group]:
    """The same, and for an administrator all that people share."""
    return session.scalars(governed_groups(viewer).order_by(*_OWN_FIRST)).all()


def find(session: Session, viewer: Viewer, group_id: UUID) -> Group | None:
    """One group, if it is there for this person."""
    return session.scalar(governed_groups(viewer).where(Group.id == group_id))


def lock(session: Session, group_id: UUID) -> None:
    """Nobody else changes who is in it until this transaction ends."""
    session.execute(select(Group.id).where(Group.id == group_id).with_for_update(key_share=True))


def rights(session: Session, person_id: UUID | None) -> Mapping[UUID, Right]:
    """What a person may do, by group."""
    query = select(Membership.group_id, Membership.right).where(Membership.person_id == person_id)
    return dict(session.execute(query).all())


def n_members(session: Session, group_ids: Sequence[UUID]) -> Mapping[UUID, int]:
    """How many are in each group."""
    query = select(Membership.group_id, func.count()).where(Membership.group_id.in_(group_ids))
    return dict(session.execute(query.group_by(Membership.group_id)).all())


def members(session: Session, group_id: UUID) -> Sequence[Membership]:
    """Everybody in a group, in the order in which they came."""
    query = select(Membership).options(joinedload(Membership.person)).where(Membership.group_id == group_id)
    return session.scalars(query.order_by(Membership.created_at, Membership.person_id)).all()


def membership(session: Session, group_id: UUID, person_id: UUID) -> Membership | None:
    """One member."""
    return session.get(Membership, (person_id, group_id))


def shared_by_name(session: Session, name: str) -> Group | None:
    """The oldest group of this name that is nobody's own space."""
    query = select(Group).where(Group.name == name, Group.personal_of.is_(None))
    return session.scalar(query.order_by(Group.created_at, Group.id).limit(1))


def has_experiments(session: Session, group_id: UUID) -> bool:
    """Whether anything belongs to it."""
    return session.scalar(select(Experiment.id).where(Experiment.group_id == group_id).limit(1)) is not None


def open_invitations(session: Session, group_id: UUID) -> Sequence[Invitation]:
    """Invitations that somebody could accept."""
    query = select(Invitation).where(
        Invitation.group_id == group_id, Invitation.used_at.is_(None), Invitation.expires_at > func.now()
    )
    return session.scalars(query.order_by(Invitation.created_at)).all()


def invitation(session: Session, secret: str) -> Invitation | None:
    """The open invitation of this secret; nobody else accepts it until this transaction ends."""
    query = select(Invitation).where(
        Invitation.secret_hash == hashed(secret), Invitation.used_at.is_(None), Invitation.expires_at > func.now()
    )
    return session.scalar(query.with_for_update(of=Invitation))
