"""/groups and /invitations."""

from http import HTTPStatus
from uuid import UUID

from fastapi import APIRouter

from backend.groups import schemas, service
from backend.groups.errors import (
    GroupNotEmpty,
    LastManager,
    NoSuchGroup,
    NoSuchInvitation,
    NoSuchMember,
    PersonalGroup,
)
from backend.platform.dependencies import (
    AccountDependency,
    AdministratorDependency,
    ManagerDependency,
    PlatformDependency,
    SessionDependency,
    ViewerDependency,
)
from backend.platform.problems import InvalidRequest, responses

router = APIRouter(prefix="/groups", tags=["groups"])


@router.get("")
def groups_list(session: SessionDependency, platform: PlatformDependency, viewer: ViewerDependency) -> schemas.Groups:
    """List the groups you are in, with what they use of the disk; administrators see all that people share."""
    groups = service.governed(session, viewer)
    return schemas.Groups(items=service.shown_as(session, platform.settings, viewer, groups))


@router.post("", status_code=HTTPStatus.CREATED, responses=responses(InvalidRequest))
def groups_create(
    session: SessionDependency, platform: PlatformDependency, viewer: AccountDependency, new: schemas.NewGroup
) -> schemas.OwnGroup:
    """Make a group. You manage it."""
    group = service.create(session, viewer, new.name)
    return service.shown_as(session, platform.settings, viewer, [group])[0]


@router.get("/{group_id}", responses=responses(NoSuchGroup, InvalidRequest))
def groups_get(
    session: SessionDependency, platform: PlatformDependency, viewer: ViewerDependency, group_id: UUID
) -> schemas.OwnGroup:
    """Look at one group."""
    return service.shown_as(session, platform.settings, viewer, [service.get(session, viewer, group_id)])[0]


@router.patch("/{group_id}", responses=responses(NoSuchGroup, InvalidRequest))
def groups_update(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    change: schemas.ChangeGroup,
) -> schemas.OwnGroup:
    """Give a group another name."""
    group = service.rename(session, viewer, group_id, change.name)
    return service.shown_as(session, platform.settings, viewer, [group])[0]


@router.put("/{group_id}/limits", responses=responses(NoSuchGroup, InvalidRequest))
def groups_limit(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    _: AdministratorDependency,
    group_id: UUID,
    limits: schemas.Limits,
) -> schemas.OwnGroup:
    """Say how much of the disk and how many runs at once a group may have; null: what the service's settings say."""
    group = service.limit(session, viewer, group_id, limits)
    return service.shown_as(session, platform.settings, viewer, [group])[0]


@router.delete(
    "/{group_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchGroup, GroupNotEmpty, PersonalGroup, InvalidRequest),
)
def groups_delete(session: SessionDependency, viewer: ManagerDependency, group_id: UUID) -> None:
    """Remove a group to which no experiment belongs."""
    service.delete(session, viewer, group_id)


@router.get("/{group_id}/members", responses=responses(NoSuchGroup, InvalidRequest))
def members_list(session: SessionDependency, viewer: ViewerDependency, group_id: UUID) -> schemas.Members:
    """List who is in a group."""
    return schemas.Members(items=service.members(session, viewer, group_id))


@router.put(
    "/{group_id}/members/{person_id}",
    responses=responses(NoSuchGroup, NoSuchMember, PersonalGroup, LastManager, InvalidRequest),
)
def members_set(
    session: SessionDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    person_id: UUID,
    change: schemas.ChangeMember,
) -> schemas.Member:
    """Give a member another right. An administrator may add anybody; others invite."""
    return service.set_member(session, viewer, group_id, person_id, change.right)


@router.delete(
    "/{group_id}/members/{person_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchGroup, NoSuchMember, PersonalGroup, LastManager, InvalidRequest),
)
def members_remove(session: SessionDependency, viewer: AccountDependency, group_id: UUID, person_id: UUID) -> None:
    """Take somebody out of a group you manage, or leave one yourself."""
    service.remove_member(session, viewer, group_id, person_id)


@router.get("/{group_id}/invitations", responses=responses(NoSuchGroup, InvalidRequest))
def invitations_list(session: SessionDependency, viewer: ManagerDependency, group_id: UUID) -> schemas.Invitations:
    """List the invitations that nobody accepted yet."""
    return schemas.Invitations(items=service.invitations(session, viewer, group_id))


@router.post(
    "/{group_id}/invitations",
    status_code=HTTPStatus.CREATED,
    responses=responses(NoSuchGroup, PersonalGroup, InvalidRequest),
)
def invitations_create(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    new: schemas.NewInvitation,
) -> schemas.MadeInvitation:
    """Invite somebody. The link is shown this once, and lets one person in."""
    return service.invite(session, platform.settings, viewer, group_id, new)


@router.delete(
    "/{group_id}/invitations/{invitation_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchGroup, NoSuchInvitation, InvalidRequest),
)
def invitations_delete(
    session: SessionDependency, viewer: ManagerDependency, group_id: UUID, invitation_id: UUID
) -> None:
    """Take an invitation back."""
    service.uninvite(session, viewer, group_id, invitation_id)
