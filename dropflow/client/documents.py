"""What a server says of experiments and runs, typed. What a newer server adds is left out, not refused."""

from datetime import datetime
from typing import Any, Literal
from uuid import UUID

from pydantic import BaseModel, ConfigDict


class _Document(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True, use_attribute_docstrings=True)


class FieldError(_Document):
    """What is wrong with one field."""

    field: str
    message: str


class Problem(_Document):
    """What went wrong, where, and what to do."""

    code: str
    detail: str
    errors: tuple[FieldError, ...] = ()
    file: str | None = None
    frame: int | None = None
    hint: str | None = None


class Group(_Document):
    """People who share experiments."""

    id: UUID
    name: str


class Importing(_Document):
    """How far an import is."""

    size_bytes: int
    done_bytes: int


class Stack(_Document):
    """The frames of an experiment."""

    state: str
    """``empty``, ``uploading``, ``indexing``, ``ready``, ``rejected`` or ``expired``."""
    n_files: int
    size_bytes: int
    n_frames: int | None = None
    rows: int | None = None
    columns: int | None = None
    duration_s: float | None = None
    done_frames: int | None = None
    importing: Importing | None = None
    problem: Problem | None = None
    warnings: tuple[str, ...] = ()


class Stage(_Document):
    """How far one stage of a run is."""

    name: str
    state: str
    done_frames: int
    total_frames: int
    frames_per_s: float | None = None
    seconds_left: float | None = None


class ExperimentDocument(_Document):
    """What was filmed, and its frames."""

    id: UUID
    group: Group
    experiment: dict[str, Any]
    created_at: datetime
    updated_at: datetime
    stack: Stack
    n_runs: int


class RunDocument(_Document):
    """One analysis."""

    id: UUID
    experiment_id: UUID
    number: int
    state: Literal["queued", "running", "completed", "failed", "cancelled"]
    parameters: dict[str, Any]
    created_at: datetime
    started_at: datetime | None = None
    finished_at: datetime | None = None
    version: str
    stages: tuple[Stage, ...]
    problem: Problem | None = None
    summary: dict[str, Any] | None = None
    warnings: tuple[str, ...] = ()

    @property
    def is_over(self) -> bool:
        """Whether it has ended, well or not."""
        return self.state in ("completed", "failed", "cancelled")


class ResultFile(_Document):
    """Something to download."""

    name: str
    size_bytes: int
    media_type: str
    sha256: str | None = None


class UploadedFile(_Document):
    """A file as the server has it."""

    id: UUID
    name: str
    size_bytes: int
    sha256: str
    role: str
