"""Uploaded files as the API shows them."""

from enum import StrEnum
from uuid import UUID

from pydantic import BaseModel, ConfigDict

from backend.platform.pages import Page


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


class Files(Page[File]):
    """Some uploaded files."""
