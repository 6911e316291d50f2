"""Rows for any table as it is in a database: for what must work on data that no test was written for."""

import re
import uuid
from datetime import UTC, datetime, timedelta
from typing import Any

import sqlalchemy as sa
from sqlalchemy.dialects.postgresql import JSONB

LEFT_OUT = "alembic_version"
_NOW = datetime(2025, 3, 1, tzinfo=UTC)
Row = dict[str, Any]


def reflected(connection: sa.Connection) -> sa.MetaData:
    """The tables as they are."""
    found = sa.MetaData()
    found.reflect(connection)
    return found


def fill_empty_tables(connection: sa.Connection, n_rows: int = 2) -> None:
    """Put rows into every table that has none, those that others refer to first."""
    for table in reflected(connection).sorted_tables:
        if table.name == LEFT_OUT or connection.execute(sa.select(table).limit(1)).first():
            continue
        allowed = _allowed(connection, table)
        for number in range(n_rows):
            row = {
                column.name: _value(connection, column, number, allowed) for column in table.columns if _is_ours(column)
            }
            _insert(connection, table, row)


def _insert(connection: sa.Connection, table: sa.Table, row: Row) -> None:
    """Put in a row, or one with a column less where not all may be given at once."""
    dispensable = [column.name for column in table.columns if column.nullable and row.get(column.name) is not None]
    refused: sa.exc.IntegrityError | None = None
    for left_out in (None, *dispensable):
        given = {name: value for name, value in row.items() if name != left_out}
        try:
            with connection.begin_nested():
                connection.execute(table.insert().values(given))
        except sa.exc.IntegrityError as problem:
            refused = refused or problem
        else:
            return
    assert refused is not None
    raise refused


def all_rows(connection: sa.Connection) -> dict[str, list[Row]]:
    """Every row of every table, in the order of its primary key."""
    found = {}
    for table in reflected(connection).sorted_tables:
        if table.name != LEFT_OUT:
            rows = connection.execute(sa.select(table).order_by(*table.primary_key.columns)).mappings()
            found[table.name] = [dict(row) for row in rows]
    return found


def _is_ours(column: sa.Column[Any]) -> bool:
    return column.identity is None and column.computed is None


def _value(connection: sa.Connection, column: sa.Column[Any], number: int, allowed: dict[str, str]) -> Any:
    for key in column.foreign_keys:
        there = connection.execute(sa.select(key.column).order_by(key.column)).scalars().all()
        return there[number % len(there)] if there else None  # none: it refers to its own table
    if column.name in allowed:
        return allowed[column.name]
    match column.type:
        case sa.Uuid():
            return uuid.uuid4()
        case JSONB():
            return {"number": number, "text": "größer als 3 µm"}
        case sa.String():
            return f"{column.name} {number} µ"[: column.type.length]
        case sa.LargeBinary():
            return bytes([0, number, 255])
        case sa.Boolean():
            return bool(number % 2)
        case sa.DateTime():
            return _NOW + timedelta(days=number)
        case sa.Integer():
            return number + 1
        case sa.Numeric() | sa.Double():
            return number + 0.25
    raise NotImplementedError(f"{column.table.name}.{column.name} is of a type without an example: {column.type!r}")


def _allowed(connection: sa.Connection, table: sa.Table) -> dict[str, str]:
    """For columns that take only some words: the first of them."""
    found = {}
    for check in sa.inspect(connection).get_check_constraints(table.name):
        words = re.findall(r"'([^']*)'", check["sqltext"])
        for column in table.columns:
            if words and re.search(rf"\b{column.name}\b", check["sqltext"]):
                found[column.name] = words[0]
    return found
