"""What can be done with groups, their members and invitations."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from uuid import UUID

from sqlalchemy import func
from sqlalchemy.orm import Session

from backend.groups import quotas, repository, schemas
from backend.groups.errors import (
    GroupNotEmpty,
    LastManager,
    NoSuchGroup,
    NoSuchInvitation,
    NoSuchMember,
    PersonalGroup,
)
from backend.models import Group, Invitation, Membership, Person, Right
from backend.platform.audit import tell
from backend.platform.secrets import hashed, new_secret
from backend.platform.settings import Settings
from backend.platform.visibility import MayNot, Viewer


def group_for_new(session: Session, viewer: Viewer, group_id: UUID | None) -> Group:
    """The group that a new experiment goes to: the one asked for, else this person's first, which is their own."""
    groups = repository.groups(session, viewer)
    chosen = next((group for group in groups if group_id in (None, group.id)), None)
    if chosen is not None:
        return chosen
    if any(group.id == group_id for group in repository.groups(session, viewer.only_looking())):
        raise MayNot(viewer.needs)
    raise NoSuchGroup


def get(session: Session, viewer: Viewer, group_id: UUID) -> Group:
    """One group, with the right that the viewer needs."""
    group = repository.find(session, viewer, group_id)
    if group is not None:
        return group
    if repository.find(session, viewer.only_looking(), group_id) is not None:
        raise MayNot(viewer.needs)
    raise NoSuchGroup


def own(session: Session, viewer: Viewer) -> Sequence[Group]:
    """The groups of this person."""
    return repository.groups(session, viewer)


def governed(session: Session, viewer: Viewer) -> Sequence[Group]:
    """The groups of this person; for an administrator all that people share."""
    return repository.governed(session, viewer)


def shown_as(session: Session, settings: Settings, viewer: Viewer, groups: Sequence[Group]) -> list[schemas.OwnGroup]:
    """Groups as their members see them; four queries for any number."""
    ids = [group.id for group in groups]
    rights = repository.rights(session, viewer.person_id)
    n_members = repository.n_members(session, ids)
    usages = quotas.usages(session, settings, groups)
    return [
        schemas.OwnGroup(
            id=group.id,
            name=group.name,
            is_personal=group.personal_of is not None,
            right=rights.get(group.id),
            n_members=n_members.get(group.id, 0),
            usage=usages[group.id],
        )
        for group in groups
    ]


def create(session: Session, viewer: Viewer, name: str) -> Group:
    """Make a group that its maker manages."""
    group = Group(name=name)
    session.add(group)
    session.flush()
    session.add(Membership(person_id=viewer.person_id, group_id=group.id, right=Right.MANAGE))
    session.flush()
    tell(session, group_id=group.id, name=name)
    return group


def rename(session: Session, viewer: Viewer, group_id: UUID, name: str) -> Group:
    """Give a group another name."""
    group = get(session, viewer, group_id)
    group.name = name
    session.flush()
    tell(session, name=name)
    return group


def limit(session: Session, viewer: Viewer, group_id: UUID, limits: schemas.Limits) -> Group:
    """Say what a group may use."""
    group = get(session, viewer, group_id)
    group.max_bytes, group.max_active_runs = limits.max_bytes, limits.max_active_runs
    session.flush()
    tell(session, name=group.name, **limits.model_dump())
    return group


def delete(session: Session, viewer: Viewer, group_id: UUID) -> None:
    """Remove a group to which nothing belongs."""
    group = _shared(session, viewer, group_id)
    if repository.has_experiments(session, group_id):
        raise GroupNotEmpty
    tell(session, name=group.name)
    session.delete(group)


def members(session: Session, viewer: Viewer, group_id: UUID) -> list[schemas.Member]:
    """Everybody in a group."""
    get(session, viewer, group_id)
    return [_shown_member(found) for found in repository.members(session, group_id)]


def set_member(session: Session, viewer: Viewer, group_id: UUID, person_id: UUID, right: Right) -> schemas.Member:
    """Give a member another right; who is none yet, only an administrator puts there."""
    _shared(session, viewer, group_id)
    member = repository.membership(session, group_id, person_id)
    if member is None:
        member = _added(session, viewer, group_id, person_id, right)
    elif right is not Right.MANAGE:
        _refuse_last(session, member)
    member.right = right
    session.flush()
    session.refresh(member)
    tell(session, person=member.person.name, right=right)
    return _shown_member(member)


def remove_member(session: Session, viewer: Viewer, group_id: UUID, person_id: UUID) -> None:
    """Take somebody out of a group; everybody may leave by themselves."""
    needs = Right.VIEW if person_id == viewer.person_id else Right.MANAGE
    _shared(session, replace(viewer, needs=needs), group_id)
    member = _member(session, group_id, person_id)
    _refuse_last(session, member)
    tell(session, person=member.person.name)
    session.delete(member)


def join(session: Session, group_id: UUID, person_id: UUID, right: Right) -> None:
    """Make somebody a member; who is one keeps the larger right."""
    repository.lock(session, group_id)
    member = repository.membership(session, group_id, person_id)
    if member is None:
        session.add(Membership(group_id=group_id, person_id=person_id, right=right))
    else:
        member.right = max(member.right, right, key=list(Right).index)
    session.flush()


def place(session: Session, name: str, person_id: UUID, right: Right | None) -> None:
    """Have somebody in the group of this name with a right, or with none: as a provider of sign-ins says."""
    group = repository.shared_by_name(session, name)
    if group is None:
        group = Group(name=name)
        session.add(group)
        session.flush()
    member = repository.membership(session, group.id, person_id)
    if right is None:
        if member is not None:
            session.delete(member)
    elif member is None:
        session.add(Membership(group_id=group.id, person_id=person_id, right=right))
    else:
        member.right = right
    session.flush()


def invitations(session: Session, viewer: Viewer, group_id: UUID) -> list[schemas.Invitation]:
    """The open invitations of a group."""
    get(session, viewer, group_id)
    found = repository.open_invitations(session, group_id)
    return [schemas.Invitation.model_validate(invitation) for invitation in found]


def invite(
    session: Session, settings: Settings, viewer: Viewer, group_id: UUID, new: schemas.NewInvitation
) -> schemas.MadeInvitation:
    """Make an invitation; whoever has its link can accept it, once."""
    _shared(session, viewer, group_id)
    secret = new_secret("inv_")
    invitation = Invitation(
        group_id=group_id,
        right=new.right,
        invited_by=viewer.person_id,
        secret_hash=hashed(secret),
        expires_at=datetime.now(UTC) + timedelta(days=new.days),
    )
    session.add(invitation)
    session.flush()
    session.refresh(invitation)
    tell(session, invitation_id=invitation.id, right=new.right)
    about = schemas.Invitation.model_validate(invitation).model_dump()
    return schemas.MadeInvitation(**about, link=f"{settings.address}invitation#{secret}")


def uninvite(session: Session, viewer: Viewer, group_id: UUID, invitation_id: UUID) -> None:
    """Take an invitation back."""
    get(session, viewer, group_id)
    invitation = session.get(Invitation, invitation_id)
    if invitation is None or invitation.group_id != group_id:
        raise NoSuchInvitation
    session.delete(invitation)


def welcome(session: Session, secret: str) -> schemas.Welcome:
    """What an invitation invites to."""
    invitation = held(session, secret)
    inviting = session.get(Person, invitation.invited_by) if invitation.invited_by else None
    return schemas.Welcome(
        group_name=invitation.group.name,
        right=invitation.right,
        invited_by=inviting.name if inviting else None,
        expires_at=invitation.expires_at,
    )


def held(session: Session, secret: str) -> Invitation:
    """The invitation that somebody holds."""
    invitation = repository.invitation(session, secret)
    if invitation is None:
        raise NoSuchInvitation
    return invitation


def accept(session: Session, invitation: Invitation, person_id: UUID) -> None:
    """Use an invitation up."""
    join(session, invitation.group_id, person_id, invitation.right)
    invitation.used_at = func.now()
    tell(session, group_id=invitation.group_id, group=invitation.group.name, right=invitation.right)


def _shared(session: Session, viewer: Viewer, group_id: UUID) -> Group:
    group = get(session, viewer, group_id)
    if group.personal_of is not None:
        raise PersonalGroup
    repository.lock(session, group_id)
    return group


def _member(session: Session, group_id: UUID, person_id: UUID) -> Membership:
    member = repository.membership(session, group_id, person_id)
    if member is None:
        raise NoSuchMember
    return member


def _added(session: Session, viewer: Viewer, group_id: UUID, person_id: UUID, right: Right) -> Membership:
    if not viewer.is_administrator or session.get(Person, person_id) is None:
        raise NoSuchMember
    member = Membership(group_id=group_id, person_id=person_id, right=right)
    session.add(member)
    return member


def _refuse_last(session: Session, member: Membership) -> None:
    managers = [other for other in repository.members(session, member.group_id) if other.right is Right.MANAGE]
    if managers == [member]:
        raise LastManager


def _shown_member(member: Membership) -> schemas.Member:
    person = member.person
    return schemas.Member(
        person_id=person.id, name=person.name, email=person.email, right=member.right, joined_at=member.created_at
    )
