"""The migrations make the very tables of the code."""

import os
import subprocess
import sys

import psycopg

from deploy.local.postgres import plain
from tests.services import ROOT


def _alembic(url: str, *command: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "alembic", *command],
        cwd=ROOT,
        env={**os.environ, "DATABASE_URL": url},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_migrated_tables_are_those_of_the_models(database_url: str) -> None:
    assert "No new upgrade operations detected." in _alembic(database_url, "check")


def test_migrations_can_be_undone_and_done_again(empty_database_url: str) -> None:
    _alembic(empty_database_url, "upgrade", "head")
    _alembic(empty_database_url, "downgrade", "base")
    with psycopg.connect(plain(empty_database_url)) as connection:
        left = connection.execute("SELECT tablename FROM pg_tables WHERE schemaname = 'public'").fetchall()
    assert left == [("alembic_version",)]
    _alembic(empty_database_url, "upgrade", "head")
