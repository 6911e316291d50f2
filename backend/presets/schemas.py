"""Presets as the API shows and takes them."""

from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from pydantic import BaseModel, ConfigDict, StringConstraints

from backend.platform.texts import Line

_EXAMPLE: dict[str, Any] = {"name": "Dense, bottom phase", "parameters": {"detection": {"radius_min_um": 3.0}}}


class NewPreset(BaseModel):
    """Parameters to keep under a name; what is not said has its default."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [_EXAMPLE]})

    name: Annotated[Line, StringConstraints(strip_whitespace=True, min_length=1, max_length=100)]
    parameters: dict[str, Any]


class Preset(BaseModel):
    """Parameters that a group keeps."""

    id: UUID
    group_id: UUID
    name: str
    parameters: dict[str, Any]
    """All of them, as `GET /schemas/parameters` describes them."""
    saved_by: str | None
    """Name of who saved it last; null where they are gone."""
    updated_at: datetime


class Presets(BaseModel):
    """All presets of a group, by name."""

    items: list[Preset]
