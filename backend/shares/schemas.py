"""Links to runs as the API shows and takes them."""

from datetime import datetime
from typing import Annotated
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field


class NewShare(BaseModel):
    """A link to make, and for how long."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"days": 30}]})

    days: Annotated[int, Field(ge=1, le=365, strict=True)] = 30


class Share(BaseModel):
    """A link by which anybody may look at a run."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    created_at: datetime
    expires_at: datetime
    used_at: datetime | None


class MadeShare(Share):
    """The same with its address, which is shown this once."""

    link: str


class Shares(BaseModel):
    """The links of a run that work."""

    items: list[Share]
