"""A creation whose service is killed in the middle: asked for again, it is there once."""

import threading
import time

import httpx
import psycopg
import pytest

from deploy.local.folder import open_folder
from deploy.local.options import Options
from deploy.local.postgres import Postgres, plain
from deploy.local.processes import Child, free_port
from deploy.local.services import api, environment_of
from tests.films import EXPERIMENT
from tests.services import scratch_folder

KEY = {"Idempotency-Key": "killed"}


@pytest.mark.slow
def test_killed_before_its_end_a_creation_leaves_nothing_and_is_done_by_the_next_try(
    postgres_server: Postgres, database_url: str, redis_url: str
) -> None:
    options = Options(port=free_port())
    with scratch_folder() as scratch, open_folder(Options(port=options.port, data=scratch)) as folder:
        program = api(folder, environment_of(options, folder, database_url=database_url, redis_url=redis_url))
        service = _started(program.start(), options.port)
        with psycopg.connect(plain(database_url)) as blocker:
            blocker.execute("LOCK TABLE stack IN ACCESS EXCLUSIVE MODE")  # its last insert waits here
            asking = threading.Thread(target=_create, args=(options.port,))
            asking.start()
            _await_waiting(database_url)
            service.process.kill()
            asking.join()
        service.stop()
        service = _started(program.start(), options.port)
        try:
            first, again = _create(options.port), _create(options.port)
            assert first is not None
            assert again is not None
            assert "idempotency-replayed" not in first.headers
            assert again.headers["idempotency-replayed"] == "true"
            (only,) = httpx.get(f"http://127.0.0.1:{options.port}/api/v1/experiments").json()["items"]
            assert only["id"] == first.json()["id"] == again.json()["id"]
        finally:
            service.stop()


def _create(port: int) -> httpx.Response | None:
    try:
        address = f"http://127.0.0.1:{port}/api/v1/experiments"
        return httpx.post(address, json={"experiment": EXPERIMENT}, headers=KEY, timeout=60)
    except httpx.TransportError:
        return None


def _started(child: Child, port: int) -> Child:
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        assert child.is_running, child.last_words(30)
        try:
            if httpx.get(f"http://127.0.0.1:{port}/api/v1/health").status_code == 200:
                return child
        except httpx.TransportError:
            time.sleep(0.2)
    raise AssertionError(child.last_words(30))


def _await_waiting(database_url: str) -> None:
    deadline = time.monotonic() + 60
    query = "SELECT count(*) FROM pg_locks WHERE NOT granted"
    with psycopg.connect(plain(database_url), autocommit=True) as looker:
        while looker.execute(query).fetchone() == (0,):
            assert time.monotonic() < deadline
            time.sleep(0.05)
