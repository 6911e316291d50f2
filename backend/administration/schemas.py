"""The service as its administrators see it."""

from datetime import datetime
from typing import Any
from uuid import UUID

from pydantic import BaseModel, ConfigDict

from backend.platform.pages import ListQuery, Page
from backend.platform.problems import Problem
from backend.platform.texts import Words


class QueueLength(BaseModel):
    """A queue of work."""

    name: str
    n_waiting: int
    """Pieces of work that nobody has taken yet."""
    n_running: int


class Holder(BaseModel):
    """A process that holds work now."""

    name: str
    n_shards: int
    oldest_started_at: datetime | None


class Disk(BaseModel):
    """Room for frames and results; null where the store does not say."""

    free_bytes: int | None
    frames_bytes: int
    results_bytes: int


class Trouble(BaseModel):
    """A run that failed lately, or that goes on for long."""

    run_id: UUID
    experiment_name: str
    group_name: str
    number: int
    state: str
    started_at: datetime | None
    finished_at: datetime | None
    problem: Problem | None


class Overview(BaseModel):
    """What an administrator looks at first."""

    queues: list[QueueLength]
    workers: list[Holder]
    disk: Disk
    failed: list[Trouble]
    slow: list[Trouble]


class AuditLine(BaseModel):
    """Who did what."""

    model_config = ConfigDict(from_attributes=True)

    id: int
    at: datetime
    person_id: UUID | None
    person_name: str
    via: str
    address: str
    action: str
    about: dict[str, Any]


class AuditQuery(ListQuery):
    """What to look for in the audit log."""

    person_id: UUID | None = None
    """Only what this person did."""
    action: Words | None = None
    """Only this operation, such as `runs_delete`."""


class AuditLog(Page[AuditLine]):
    """Lines of the audit log, newest first."""
