"""Fixtures for every test. Servers are real, start once a session and only when a test asks for them.

- `real_data` (session): the folder of real images; the test is skipped where it is absent.
- `postgres_server` (session): a running `deploy.local.postgres.Postgres`.
- `database_url`: SQLAlchemy URL of a database of this test alone, migrated to head (a copy of a template: some 50 ms).
- `empty_database_url`: the same without any table, for tests of the migrations themselves.
- `valkey_server` (session): a running `deploy.local.valkey.Valkey`.
- `redis_url`: URL of its database 0, emptied before the test.
- `service` (session): API and workers as real processes with a database and queues of their own; `service.url` ends
  in a slash and serves the page too. For other settings use `tests.services.running_service`.
"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest
import redis

from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.services import (
    MIGRATED,
    ROOT,
    RunningService,
    database,
    migrate,
    running_postgres,
    running_service,
    running_valkey,
)

# A busy machine is no failure: what is too slow is found by the timeout of a test.
hypothesis.settings.register_profile("patient", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow])
hypothesis.settings.load_profile("patient")


@pytest.fixture(scope="session")
def real_data() -> Path:
    folder = Path(os.environ.get("DROPFLOW_REAL_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no real images at {folder}; set DROPFLOW_REAL_DATA to their folder")
    return folder


@pytest.fixture(scope="session")
def postgres_server() -> Iterator[Postgres]:
    with running_postgres() as server:
        yield server


@pytest.fixture(scope="session")
def migrated_template(postgres_server: Postgres) -> str:
    postgres_server.create_database(MIGRATED)
    migrate(postgres_server.url(MIGRATED))
    return MIGRATED


@pytest.fixture
def database_url(postgres_server: Postgres, migrated_template: str) -> Iterator[str]:
    with database(postgres_server, template=migrated_template) as url:
        yield url


@pytest.fixture
def empty_database_url(postgres_server: Postgres) -> Iterator[str]:
    with database(postgres_server, template="template0") as url:
        yield url


@pytest.fixture(scope="session")
def valkey_server() -> Iterator[Valkey]:
    with running_valkey() as server:
        yield server


@pytest.fixture
def redis_url(valkey_server: Valkey) -> str:
    url = valkey_server.url(0)
    with redis.Redis.from_url(url) as client:
        client.flushdb()
    return url


@pytest.fixture(scope="session")
def service(postgres_server: Postgres, migrated_template: str, valkey_server: Valkey) -> Iterator[RunningService]:
    with (
        database(postgres_server, template=migrated_template) as url,
        running_service(url, valkey_server.url(1)) as running,
    ):
        yield running


_exit_status = pytest.StashKey[int]()


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Keep what the run came to for `pytest_unconfigure`."""
    session.config.stash[_exit_status] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Leave with the tests' own result, all reports being written and all fixtures torn down.

    So many native libraries are loaded by then that the end of the interpreter itself has crashed (all tests passed,
    signal 11) and has waited for ever for a thread that a failing test left behind.
    """
    status = config.stash.get(_exit_status, None)
    if status is not None:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
