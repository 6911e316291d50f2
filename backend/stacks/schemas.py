"""Uploaded files as the API shows them."""

from enum import StrEnum
from typing import Annotated
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field

from backend.platform.pages import ListQuery, Page
from backend.platform.texts import Words


class Role(StrEnum):
    """What a file is for: frames, or what the experiment's document names beside them."""

    FRAMES = "frames"
    FLAT_FIELD = "flat_field"
    TIMESTAMPS = "timestamps"
    TEMPERATURE_LOG = "temperature_log"


class File(BaseModel):
    """One uploaded file."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    name: str
    size_bytes: int
    sha256: str
    role: Role


class Confirm(BaseModel):
    """What a person has seen and says is right: as `stack` and the description of the experiment say it."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [{"checksum": "9f86d0", "n_frames": 200, "duration_s": 199.0, "pixel_size_um": 0.625}]
        },
    )

    checksum: Annotated[Words, Field(max_length=64)]
    n_frames: int
    duration_s: float
    pixel_size_um: float


class Files(Page[File]):
    """Some uploaded files."""


class FileSort(StrEnum):
    """What files are sorted by; a minus means the largest or last first."""

    NAME = "name"
    NAME_REVERSED = "-name"
    SMALLEST = "size_bytes"
    LARGEST = "-size_bytes"


class FileQuery(ListQuery):
    """Which files, and in which order."""

    limit: Annotated[int, Field(ge=1, le=500)] = 500
    """Most items to answer."""
    sort: FileSort = FileSort.NAME
    """The order. By name, the files of each role stand together."""
    role: Role | None = None
    """Files for this purpose."""
    q: Annotated[Words, Field(max_length=200)] | None = None
    """A part of the name, in any case."""
