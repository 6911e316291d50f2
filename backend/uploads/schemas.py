"""Uploads as the API shows and takes them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field

from backend.platform.problems import Problem
from backend.stacks.schemas import Role

MAX_FILES = 2000
Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Announced(BaseModel):
    """A file that somebody wants to send."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    size_bytes: Annotated[int, Field(ge=0, strict=True)]
    role: Role = Role.FRAMES
    sha256: Sha256 | None = None
    """If given, a file of this name and size that is there with another checksum is to be sent anew."""

    @property
    def key(self) -> tuple[str, str]:
        """What tells the files of an experiment apart."""
        return (self.role, self.name)


class NewPlan(BaseModel):
    """The files that somebody wants to be here."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"files": [{"name": "film/frame0001.tif", "size_bytes": 5_242_880}]}]},
    )

    files: Annotated[list[Announced], Field(min_length=1, max_length=MAX_FILES)]


class PlannedUpload(BaseModel):
    """Bytes to be sent in one go: those of its files, one after the other, from `offset_bytes` on."""

    id: UUID
    location: str
    """Relative to /api/v1/. It speaks tus 1.0."""
    size_bytes: int
    offset_bytes: int
    files: list[int]
    """Places in the list of the request, in the order of their bytes."""


class Present(BaseModel):
    """A file that is here already."""

    file: int
    """Its place in the list of the request."""
    sha256: str


class Plan(BaseModel):
    """What is to be sent, and what need not."""

    uploads: list[PlannedUpload]
    present: list[Present]


class UploadState(StrEnum):
    """Whether an upload can still be sent."""

    OPEN = "open"
    REFUSED = "refused"
    FINISHED = "finished"


class Upload(BaseModel):
    """One upload on its way."""

    id: UUID
    state: UploadState
    size_bytes: int
    offset_bytes: int
    n_files: int
    first_name: str
    expires_at: datetime
    problem: Problem | None
    """Why it was refused."""


class Uploads(BaseModel):
    """What was announced and has not arrived."""

    n_files_missing: int
    n_bytes_missing: int
    items: list[Upload]
    """The first hundred, oldest first."""
