"""Tokens as the API shows and takes them."""

from datetime import datetime
from typing import Annotated
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field

from backend.groups.schemas import Name
from backend.models import Scope


class NewToken(BaseModel):
    """A token to make. `read` looks; `submit` also uploads, runs and deletes; `admin` does all that you can."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"name": "microscope", "scope": "submit", "days": 90}]}
    )

    name: Name
    scope: Scope = Scope.READ
    days: Annotated[int, Field(ge=1, le=3660, strict=True)] = 90


class Token(BaseModel):
    """A token without its secret."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    name: str
    beginning: str
    """Its first characters, to tell it from others."""
    scope: Scope
    created_at: datetime
    expires_at: datetime
    used_at: datetime | None
    """When it was last used, to the minute."""


class MadeToken(Token):
    """The same with its secret, which is shown this once."""

    secret: str


class Tokens(BaseModel):
    """Your tokens that were not revoked."""

    items: list[Token]
