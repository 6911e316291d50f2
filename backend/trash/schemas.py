"""The trash as the API shows it."""

from datetime import datetime
from enum import StrEnum
from uuid import UUID

from pydantic import BaseModel


class Kind(StrEnum):
    """What lies in the trash."""

    EXPERIMENT = "experiment"
    RUN = "run"
    FRAMES = "frames"


class TrashedThing(BaseModel):
    """Something in the trash."""

    kind: Kind
    experiment_id: UUID
    run_id: UUID | None
    name: str
    """Of the experiment, or of the run's."""
    number: int | None
    """Of a run."""
    group: str
    size_bytes: int
    """What emptying the trash gives back."""
    trashed_at: datetime
    trashed_by: str | None
    """None: the service itself, for its time was over."""
    goes_at: datetime | None
    """When it will be removed for good."""


class Trash(BaseModel):
    """All that lies in the trash of one's groups, what came last first."""

    items: list[TrashedThing]
    size_bytes: int


class Emptied(BaseModel):
    """What emptying the trash has removed."""

    n_items: int
    size_bytes: int
