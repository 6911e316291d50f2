"""The real servers that tests run on, started as the launcher starts them."""

import os
import secrets
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from deploy.local.postgres import Postgres, new_password
from deploy.local.valkey import Valkey

ROOT = Path(__file__).parents[1]
MIGRATED = "migrated_template"


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """A folder outside pytest's own, which keeps the last runs: a cluster is too big to be kept."""
    folder = Path(tempfile.mkdtemp(prefix="dropflow-test-"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder)


@contextmanager
def running_postgres() -> Iterator[Postgres]:
    with scratch_folder() as folder:
        server = Postgres(folder, password=new_password(), log=folder / "log", is_durable=False)
        child = server.start()
        try:
            yield server
        finally:
            child.stop()


@contextmanager
def running_valkey() -> Iterator[Valkey]:
    with scratch_folder() as folder:
        server = Valkey(folder, password=new_password(), log=folder / "log", is_durable=False)
        child = server.start()
        try:
            yield server
        finally:
            child.stop()


@contextmanager
def database(server: Postgres, *, template: str) -> Iterator[str]:
    """The URL of a new database that is a copy of `template` and is gone afterwards."""
    name = f"test_{secrets.token_hex(6)}"
    server.create_database(name, template=template)
    try:
        yield server.url(name)
    finally:
        server.drop_database(name)


def migrate(url: str) -> None:
    """Bring a database to the newest form, as a deployment does."""
    done = subprocess.run(
        [sys.executable, "-m", "alembic", "upgrade", "head"],
        cwd=ROOT,
        env={**os.environ, "DATABASE_URL": url},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"alembic upgrade head failed:\n{done.stdout}\n{done.stderr}"
