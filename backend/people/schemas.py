"""People and groups as the API shows them."""

from uuid import UUID

from pydantic import BaseModel, ConfigDict


class Group(BaseModel):
    """The group that something belongs to."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    name: str
