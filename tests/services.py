"""The real servers that tests run on, started as the launcher starts them."""

import os
import secrets
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from deploy.local.answers import status_of
from deploy.local.folder import open_folder
from deploy.local.options import Options
from deploy.local.postgres import Postgres, new_password
from deploy.local.processes import Child, free_port
from deploy.local.services import Program, api, environment_of, workers
from deploy.local.supervisor import Supervisor
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


@dataclass(frozen=True)
class RunningService:
    """API and workers as processes, as the launcher starts them. `logs` is where each of them writes."""

    url: str
    environment: Mapping[str, str]
    logs: Path
    children: Mapping[str, Child]


@contextmanager
def running_service(database_url: str, redis_url: str, **settings: str) -> Iterator[RunningService]:
    """Start all of it on a free port; `settings` are further variables, such as LEASE_S."""
    supervisor = Supervisor(print)
    options = Options(port=free_port())
    with scratch_folder() as scratch, open_folder(Options(port=options.port, data=scratch)) as folder:
        variables = environment_of(options, folder, database_url=database_url, redis_url=redis_url) | settings
        programs: list[Program] = [api(folder, variables), *workers(folder, variables)]
        try:
            children = {program.name: supervisor.start(program, tier=0) for program in programs}
            _await_health(options.port, children["API"])
            yield RunningService(options.address, variables, folder.logs, children)
        finally:
            supervisor.stop()


def _await_health(port: int, child: Child) -> None:
    deadline = time.monotonic() + 180
    while status_of(port, "/api/v1/health") != 200:
        assert child.is_running, child.last_words(30)
        assert time.monotonic() < deadline, child.last_words(30)
        time.sleep(0.05)
