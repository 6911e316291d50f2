"""Webhooks and what they were told as the API shows and takes them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any
from uuid import UUID

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StrictBool, StringConstraints

from backend.models import Event, NoticeState
from backend.platform.pages import ListQuery, Page
from backend.platform.texts import Line


class Asked(StrEnum):
    """What a webhook can ask to be told."""

    RUN_COMPLETED = Event.RUN_COMPLETED
    RUN_FAILED = Event.RUN_FAILED
    RUN_CANCELLED = Event.RUN_CANCELLED


def _each_once(events: list[Asked]) -> list[Asked]:
    return list(dict.fromkeys(events))


Address = Annotated[Line, StringConstraints(strip_whitespace=True, min_length=1, max_length=2000)]
Events = Annotated[list[Asked], Field(min_length=1, max_length=20), AfterValidator(_each_once)]


class NewWebhook(BaseModel):
    """Where to, and what."""

    model_config = ConfigDict(
        extra="forbid",
        use_attribute_docstrings=True,
        json_schema_extra={"examples": [{"address": "https://example.org/hook", "events": ["run.completed"]}]},
    )

    address: Address
    """An address that takes POST requests."""
    events: Events = [Asked.RUN_COMPLETED, Asked.RUN_FAILED]
    """What it is told."""


class ChangeWebhook(BaseModel):
    """What to change; what is absent stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"is_active": False}]})

    address: Address | None = None
    events: Events | None = None
    is_active: StrictBool | None = None


class Webhook(BaseModel):
    """An address that is told what happens in a group."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    address: str
    events: list[Asked]
    is_active: bool
    created_at: datetime


class Webhooks(BaseModel):
    """The webhooks of a group."""

    items: list[Webhook]


class MadeWebhook(Webhook):
    """The same with the secret that its notices are signed with, which is shown this once."""

    secret: str


class Try(BaseModel):
    """One try to send."""

    at: datetime
    seconds: float
    status: int | None
    """Of the receiver's answer; null where there was none."""
    problem: str | None


class Notice(BaseModel):
    """What a webhook was told, or is to be told."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    """It goes with every try, as `webhook-id`."""
    event: Event
    about: dict[str, Any]
    """`data` of what is sent, without the address of the run."""
    resend_of: UUID | None
    """The notice of which somebody asked that it be sent again."""
    created_at: datetime
    state: NoticeState
    tries: list[Try]
    next_try_at: datetime | None


class Notices(Page[Notice]):
    """Some notices."""


class NoticeQuery(ListQuery):
    """Which notices, newest first."""

    state: NoticeState | None = None
    """Those in this state."""
