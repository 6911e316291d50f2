"""All rows of the database out of it and into it, through COPY: any server's version, no program beside this one."""

import hashlib
from collections.abc import Iterator
from pathlib import Path

import psycopg
from psycopg import sql
from sqlalchemy import Connection, MetaData, inspect

VERSION_TABLE = "alembic_version"
_READ_BYTES = 1 << 20


def table_names(connection: Connection) -> list[str]:
    """All tables but Alembic's own, those that others refer to first."""
    metadata = MetaData()
    metadata.reflect(connection)
    return [table.name for table in metadata.sorted_tables if table.name != VERSION_TABLE]


def revision_of(connection: Connection) -> str | None:
    """The form of the database, None if it has none yet."""
    if not inspect(connection).has_table(VERSION_TABLE):
        return None
    return connection.exec_driver_sql(f"SELECT version_num FROM {VERSION_TABLE}").scalar()  # noqa: S608 - our own name


def write_table(connection: Connection, name: str, file: Path) -> tuple[int, str]:
    """Write a table's columns and rows to `file`; the number of rows and the file's SHA-256."""
    digest = hashlib.sha256()
    with driver(connection).cursor() as cursor, file.open("wb") as out:
        columns = _columns(cursor, name)
        header = ("\t".join(columns) + "\n").encode()
        out.write(header)
        digest.update(header)
        statement = sql.SQL("COPY {} ({}) TO STDOUT").format(sql.Identifier(name), _list(columns))
        with cursor.copy(statement) as copy:
            for block in copy:
                out.write(block)
                digest.update(block)
        return cursor.rowcount, digest.hexdigest()


def read_table(connection: Connection, name: str, file: Path) -> int:
    """Put the rows of `file` into an empty table; how many."""
    with driver(connection).cursor() as cursor, file.open("rb") as source:
        columns = source.readline().decode().rstrip("\n").split("\t")
        statement = sql.SQL("COPY {} ({}) FROM STDIN").format(sql.Identifier(name), _list(columns))
        with cursor.copy(statement) as copy:
            while block := source.read(_READ_BYTES):
                copy.write(block)
        return cursor.rowcount


def follow_identities(connection: Connection, name: str) -> None:
    """Let numbers that the database gives go on after the largest that a table has."""
    with driver(connection).cursor() as cursor:
        for column in _columns(cursor, name):
            row = cursor.execute("SELECT pg_get_serial_sequence(%s, %s)", [name, column]).fetchone()
            if row is not None and row[0] is not None:
                cursor.execute(
                    sql.SQL("SELECT setval(%s, coalesce(max({}), 0) + 1, false) FROM {}").format(
                        sql.Identifier(column), sql.Identifier(name)
                    ),
                    [row[0]],
                )


def driver(connection: Connection) -> "psycopg.Connection[tuple[object, ...]]":
    """The driver's own connection, in the same transaction."""
    raw = connection.connection.driver_connection
    assert isinstance(raw, psycopg.Connection)  # noqa: S101 - settings take no other
    return raw


def _columns(cursor: "psycopg.Cursor[tuple[object, ...]]", name: str) -> list[str]:
    """Columns that hold data of their own, in order."""
    rows = cursor.execute(
        "SELECT attname FROM pg_attribute WHERE attrelid = %s::regclass AND attnum > 0 AND NOT attisdropped"
        " AND attgenerated = '' ORDER BY attnum",
        [name],
    )
    return [str(row[0]) for row in rows]


def _list(columns: list[str]) -> sql.Composed:
    return sql.SQL(", ").join(sql.Identifier(column) for column in columns)


def checksum(file: Path) -> str:
    """SHA-256 of a file."""
    digest = hashlib.sha256()
    for block in _blocks(file):
        digest.update(block)
    return digest.hexdigest()


def _blocks(file: Path) -> Iterator[bytes]:
    with file.open("rb") as source:
        while block := source.read(_READ_BYTES):
            yield block
