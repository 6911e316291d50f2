"""Groups, members and invitations as the API shows and takes them."""

from datetime import datetime
from typing import Annotated
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from backend.models import Right
from backend.platform.texts import Line

Name = Annotated[Line, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]
Secret = Annotated[str, StringConstraints(min_length=1, max_length=200)]


class Group(BaseModel):
    """The group that something belongs to."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    name: str


class Usage(BaseModel):
    """How much of what a group may use it uses; null: no limit."""

    used_bytes: int
    max_bytes: int | None
    n_active_runs: int
    max_active_runs: int | None


class OwnGroup(Group):
    """A group as its members see it."""

    is_personal: bool
    right: Right | None
    """What you may do in it; null for an administrator who is no member."""
    n_members: int
    usage: Usage


class Groups(BaseModel):
    """Your groups."""

    items: list[OwnGroup]


class NewGroup(BaseModel):
    """A group to make."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"name": "Emulsions"}]})

    name: Name


class ChangeGroup(BaseModel):
    """What to change of a group."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"name": "Emulsions and foams"}]})

    name: Name


class Limits(BaseModel):
    """What a group may use; null: what the service's settings say."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"max_bytes": 500_000_000_000, "max_active_runs": 4}]}
    )

    max_bytes: Annotated[int, Field(ge=0, le=2**62, strict=True)] | None
    max_active_runs: Annotated[int, Field(ge=1, le=10_000, strict=True)] | None


class Member(BaseModel):
    """Somebody in a group."""

    person_id: UUID
    name: str
    email: str | None
    right: Right
    joined_at: datetime


class Members(BaseModel):
    """Everybody in a group."""

    items: list[Member]


class ChangeMember(BaseModel):
    """Another right for a member."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"right": "edit"}]})

    right: Right


class NewInvitation(BaseModel):
    """An invitation to make."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"right": "edit", "days": 7}]})

    right: Right = Right.EDIT
    days: Annotated[int, Field(ge=1, le=90, strict=True)] = 7


class Invitation(BaseModel):
    """An invitation that is open."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    right: Right
    created_at: datetime
    expires_at: datetime


class MadeInvitation(Invitation):
    """The same with its link, which is shown this once."""

    link: str


class Invitations(BaseModel):
    """The invitations of a group that are open."""

    items: list[Invitation]


class ShownInvitation(BaseModel):
    """The invitation somebody holds."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"secret": "inv_..."}]})

    secret: Secret


class Welcome(BaseModel):
    """What an invitation invites to."""

    group_name: str
    right: Right
    invited_by: str | None
    expires_at: datetime
