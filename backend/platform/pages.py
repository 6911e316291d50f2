"""Long lists page by page, the same for every noun: filters, an order, and a cursor that says where a page ended.

The cursor holds the sort key of the last item, not a count, so that rows which are added or removed meanwhile neither
repeat an item nor leave one out.
"""

import base64
import binascii
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Generic, TypeVar
from uuid import UUID

from pydantic import AwareDatetime, BaseModel, BeforeValidator, ConfigDict, Field
from sqlalchemy import ColumnElement, Select, tuple_
from sqlalchemy.orm import Session

from backend.platform.problems import InvalidRequest
from backend.platform.texts import is_storable
from dropflow.errors import FieldProblem

Item = TypeVar("Item")
Row = TypeVar("Row")


def _as_iso_8601(value: Any) -> Any:
    if isinstance(value, str) and not re.match(r"\d{4}-\d\d-\d\d[Tt ]", value):
        raise ValueError("give a time such as 2026-05-04T09:30:00Z")  # a bare number is no time of anybody's
    return value


Moment = Annotated[AwareDatetime, BeforeValidator(_as_iso_8601)]
"""A time to filter by, with its time zone."""


class Page(BaseModel, Generic[Item]):
    """Some items, and how to get the next ones."""

    items: list[Item]
    next_cursor: str | None = None
    """Give it as `cursor` to go on; null on the last page."""


class ListQuery(BaseModel):
    """What every list can be asked. Nouns add their filters; a parameter that is none of them is refused."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    limit: Annotated[int, Field(ge=1, le=500)] = 50
    """Most items to answer."""
    cursor: Annotated[str, Field(max_length=8000)] | None = None
    """`next_cursor` of the page before, asked for in the same order."""


@dataclass(frozen=True)
class Order:
    """What a list is sorted by. `keys` are never null, and no two rows have the same values of all of them."""

    name: str
    keys: tuple[ColumnElement[Any], ...]
    is_descending: bool = False


def page_of(
    session: Session, query: Select[Row], order: Order, *, limit: int, cursor: str | None
) -> tuple[Sequence[Row], str | None]:
    """The rows of one page, and the cursor of the next one if there is any."""
    if cursor is not None:
        place = tuple_(*_values(cursor, order))
        query = query.where(tuple_(*order.keys) < place if order.is_descending else tuple_(*order.keys) > place)
    sorted_by = (key.desc() if order.is_descending else key.asc() for key in order.keys)
    asked: Select[Any] = query.add_columns(*order.keys).order_by(*sorted_by).limit(limit + 1)
    found = session.execute(asked).all()
    shown = found[:limit]
    next_cursor = _encode([order.name, *shown[-1][1:]]) if len(found) > limit else None
    return [row[0] for row in shown], next_cursor


def _encode(position: Sequence[Any]) -> str:
    return base64.urlsafe_b64encode(json.dumps(position, default=str).encode()).decode()


def _values(cursor: str, order: Order) -> list[Any]:
    """The sort key of the last item of the page before; anything that `page_of` did not make is refused."""
    try:
        name, *values = json.loads(base64.urlsafe_b64decode(cursor.encode("ascii")))
        if name != order.name:
            raise _no_cursor(f"was made for the order {name}: give it with the same `sort`")
        return [_value(key, value) for key, value in zip(order.keys, values, strict=True)]
    except (binascii.Error, ValueError, TypeError, RecursionError):
        raise _no_cursor("give next_cursor of the page before") from None


def _value(key: ColumnElement[Any], value: Any) -> Any:
    kind = key.type.python_type
    if kind is datetime:
        return datetime.fromisoformat(value)
    if kind is UUID:
        return UUID(str(value))
    if type(value) is not kind or not is_storable(str(value)):
        raise TypeError(kind)
    return value


def _no_cursor(message: str) -> InvalidRequest:
    return InvalidRequest("This is no cursor of this list.", fields=[FieldProblem("cursor", message)])
