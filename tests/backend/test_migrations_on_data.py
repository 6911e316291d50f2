"""Migrations keep what is in the tables: rows are made in every form that the database ever had, and followed."""

from collections.abc import Iterator
from uuid import UUID

import pytest
import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory

from backend.operations.migrated import alembic_config
from tests.rows import Row, all_rows, fill_empty_tables

LOCAL_PERSON, LOCAL_GROUP = (UUID(f"00000000-0000-4000-8000-00000000000{n}") for n in (1, 2))
FORMS = [script.revision for script in ScriptDirectory.from_config(alembic_config()).walk_revisions()][::-1]


@pytest.fixture
def connection(empty_database_url: str) -> Iterator[sa.Connection]:
    engine = sa.create_engine(empty_database_url)
    with engine.connect() as opened:
        yield opened
    engine.dispose()


@pytest.fixture
def config(connection: sa.Connection) -> Config:
    made = alembic_config()
    made.attributes["connection"] = connection
    return made


def assert_kept(before: dict[str, list[Row]], after: dict[str, list[Row]]) -> None:
    """No row is lost, and what was in columns that are still there is as it was."""
    for name in before.keys() & after.keys():
        assert len(after[name]) == len(before[name]), name
        for old, new in zip(before[name], after[name], strict=True):
            assert {column: old[column] for column in old.keys() & new.keys()} == {
                column: new[column] for column in old.keys() & new.keys()
            }, name


def test_rows_of_every_form_survive_the_way_up_down_and_up_again(connection: sa.Connection, config: Config) -> None:
    for form in FORMS:
        before = all_rows(connection)
        command.upgrade(config, form)
        assert_kept(before, all_rows(connection))
        fill_empty_tables(connection)
        connection.commit()
    everything = all_rows(connection)
    assert all(everything.values()), "a table has no row"
    command.check(config)
    for form in [*FORMS[-2::-1], "head"]:
        before = all_rows(connection)
        (command.upgrade if form == "head" else command.downgrade)(config, form)
        assert_kept(before, all_rows(connection))
        connection.commit()
    command.downgrade(config, "base")
    assert all_rows(connection) == {}


def test_whoever_was_alone_before_there_were_accounts_looks_after_them_afterwards(
    connection: sa.Connection, config: Config
) -> None:
    command.upgrade(config, "0007")
    for table, number in (("person", LOCAL_PERSON), ("group_", LOCAL_GROUP)):
        connection.execute(sa.text(f"INSERT INTO {table} (id, name) VALUES (:id, 'I')"), {"id": number})  # noqa: S608
    connection.execute(
        sa.text("INSERT INTO membership (person_id, group_id) VALUES (:person, :group)"),
        {"person": LOCAL_PERSON, "group": LOCAL_GROUP},
    )
    connection.commit()
    command.upgrade(config, "head")
    assert connection.execute(sa.text("SELECT is_administrator FROM person")).scalar_one() is True
    assert connection.execute(sa.text('SELECT "right" FROM membership')).scalar_one() == "manage"
    assert connection.execute(sa.text("SELECT personal_of FROM group_")).scalar_one() == LOCAL_PERSON
