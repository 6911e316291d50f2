"""Health checks believe a worker that answers, and do not blame one for a broker that is away."""

import os
import subprocess
import sys

from deploy.local.valkey import Valkey
from tests.services import ROOT, RunningService
from worker.alive import is_alive


def asked(queue: str, redis_url: str) -> int:
    command = [sys.executable, "-m", "worker.alive", queue]
    return subprocess.run(command, cwd=ROOT, env={**os.environ, "REDIS_URL": redis_url}, timeout=60).returncode


def test_a_worker_that_answers_is_alive_and_one_that_does_not_is_not(service: RunningService) -> None:
    redis_url = service.environment["REDIS_URL"]
    assert asked("ingest", redis_url) == 0
    assert not is_alive(redis_url, "nobody", patience_s=1)


def test_nobody_is_blamed_while_the_broker_is_away(valkey_server: Valkey) -> None:
    assert is_alive("redis://127.0.0.1:1/0", "shards", patience_s=1)
