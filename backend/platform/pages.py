"""Long lists page by page: a cursor says where the last page ended, and stays right while rows are added."""

import base64
import binascii
import json
from typing import Annotated, Any, Generic, TypeVar

from fastapi import Query
from pydantic import BaseModel

from backend.platform.problems import InvalidRequest
from dropflow.errors import FieldProblem

Item = TypeVar("Item")

Limit = Annotated[int, Query(ge=1, le=500, description="Most items to answer.")]
Cursor = Annotated[str | None, Query(max_length=4000, description="`next_cursor` of the page before.")]


class Page(BaseModel, Generic[Item]):
    """Some items, and how to get the next ones."""

    items: list[Item]
    next_cursor: str | None = None
    """Give it as `cursor` to go on; null on the last page."""


def encode_cursor(*position: Any) -> str:
    """Pack the sort key of the last item of a page."""
    return base64.urlsafe_b64encode(json.dumps(position, default=str).encode()).decode()


def decode_cursor(cursor: str | None, n_parts: int) -> list[Any] | None:
    """Unpack what `encode_cursor` made; anything else is refused."""
    if cursor is None:
        return None
    try:
        position = json.loads(base64.urlsafe_b64decode(cursor.encode("ascii")))
    except (binascii.Error, ValueError):
        position = None
    if not isinstance(position, list) or len(position) != n_parts:
        raise InvalidRequest(
            "This is no cursor of this list.", fields=[FieldProblem("cursor", "give next_cursor of the page before")]
        )
    return position
