"""The real thing: API, workers and reconciler as processes, killed in the middle of their work."""

import io
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import timedelta
from uuid import UUID

import httpx
import pyarrow.parquet as pq
import pytest
import redis
from sqlalchemy import Engine, func, select, update

from backend.models import Shard
from backend.models.states import ShardState
from backend.platform.database import make_engine, make_sessions
from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.films import EXPERIMENT, PARAMETERS, frame, tiff
from tests.house import Json
from tests.services import ROOT, RunningService, database, running_service

LEASE_S = 60.0
N_FRAMES = 16
SHAPE = (480, 640)


@dataclass(frozen=True)
class Machine:
    """A running service, seen through its API, with a look at its database to know whom to kill."""

    service: RunningService
    api: httpx.Client
    engine: Engine

    def experiment(self) -> Json:
        made = self.api.post("experiments", json={"experiment": EXPERIMENT}).json()
        content = tiff(*(frame(index, SHAPE) for index in range(N_FRAMES)))
        self.api.put(f"experiments/{made['id']}/files", params={"name": "film.tif"}, content=content)
        self.api.post(f"experiments/{made['id']}/stack")
        _await(lambda: self.get(f"experiments/{made['id']}")["stack"]["state"] == "ready")
        return self.get(f"experiments/{made['id']}")

    def start(self, experiment: Json) -> Json:
        answer = self.api.post(f"experiments/{experiment['id']}/runs", json={"parameters": PARAMETERS})
        assert answer.status_code == 202, answer.text
        run: Json = answer.json()
        return run

    def get(self, path: str) -> Json:
        answer = self.api.get(path)
        assert answer.status_code == 200, answer.text
        body: Json = answer.json()
        return body

    def finish(self, run: Json) -> Json:
        _await(lambda: self.get(f"runs/{run['id']}")["state"] not in {"queued", "running"}, 120)
        return self.get(f"runs/{run['id']}")

    def shards(self, run: Json, task: str | None = None) -> list[Shard]:
        query = select(Shard).where(Shard.run_id == UUID(run["id"])).order_by(Shard.start_frame)
        with make_sessions(self.engine)() as session:
            return list(session.scalars(query if task is None else query.where(Shard.task == task)))

    def kill_holder(self, run: Json, task: str) -> Shard:
        """Kill the process that works on a shard of `task`, as soon as there is one."""
        found: list[Shard] = []

        def is_held() -> bool:
            found[:] = [shard for shard in self.shards(run, task) if shard.state == ShardState.RUNNING]
            return bool(found)

        _await(is_held, pause_s=0.005)
        os.kill(_process_of(found[0]), signal.SIGKILL)
        self.let_lease_run_out(found[0])
        return found[0]

    def let_lease_run_out(self, shard: Shard) -> None:
        """Let as much time pass for this shard, whose holder is dead."""
        past = func.clock_timestamp() - timedelta(seconds=1)
        with make_sessions(self.engine).begin() as session:
            session.execute(
                update(Shard).where(Shard.id == shard.id, Shard.fence == shard.fence).values(lease_until=past)
            )


def _process_of(shard: Shard) -> int:
    host, _, process = re.fullmatch(r"(.+):(\d+):(\d+)", str(shard.holder)).groups()  # type: ignore[union-attr]
    assert host == socket.gethostname()
    return int(process)


def _await(condition: Callable[[], bool], timeout_s: float = 120.0, pause_s: float = 0.1) -> None:
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(pause_s)


@pytest.fixture(scope="module")
def machine(postgres_server: Postgres, migrated_template: str, valkey_server: Valkey) -> Iterator[Machine]:
    quick = {"LEASE_S": str(LEASE_S), "RECONCILE_EVERY_S": "0.5", "RESEND_AFTER_S": "1", "LOG_LEVEL": "WARNING"}
    with (
        database(postgres_server, template=migrated_template) as url,
        running_service(url, valkey_server.url(3), **quick) as service,
        httpx.Client(base_url=f"{service.url}api/v1/", timeout=30) as api,
    ):
        engine = make_engine(url, application="test")
        yield Machine(service, api, engine)
        engine.dispose()


@pytest.fixture(scope="module")
def undisturbed(machine: Machine) -> Json:
    return machine.finish(machine.start(machine.experiment()))


def _tables(machine: Machine, run: Json) -> list[object]:
    names = ("droplets.parquet", "trajectories.parquet", "rejected_trajectories.parquet")
    contents = (machine.api.get(f"runs/{run['id']}/files/{name}").content for name in names)
    return [pq.read_table(io.BytesIO(content)).replace_schema_metadata(None) for content in contents]


def test_a_run_that_is_left_alone_completes_with_each_shard_tried_once(machine: Machine, undisturbed: Json) -> None:
    assert undisturbed["state"] == "completed", undisturbed["problem"]
    assert {shard.attempts for shard in machine.shards(undisturbed)} == {1}


def test_workers_killed_in_mid_shard_and_a_lost_queue_change_nothing_in_the_result(
    machine: Machine, undisturbed: Json
) -> None:
    run = machine.start(machine.experiment())
    killed = machine.kill_holder(run, "detect")
    with redis.Redis.from_url(machine.service.environment["REDIS_URL"]) as broker:
        broker.flushdb()
    tracker = machine.kill_holder(run, "track")
    done = machine.finish(run)
    assert done["state"] == "completed", done["problem"]
    fences = {shard.id: shard.fence for shard in machine.shards(run)}
    assert fences[killed.id] > killed.fence
    assert fences[tracker.id] > tracker.fence
    assert done["summary"] == undisturbed["summary"]
    assert _tables(machine, done) == _tables(machine, undisturbed)
    assert [stage["done_frames"] for stage in done["stages"]] == [N_FRAMES] * 3


def _is_at_work(machine: Machine, run: Json) -> bool:
    return any(shard.state == ShardState.RUNNING for shard in machine.shards(run, "detect"))


def test_a_run_at_work_is_cancelled_within_seconds(machine: Machine) -> None:
    run = machine.start(machine.experiment())
    _await(lambda: _is_at_work(machine, run), pause_s=0.01)
    asked_s = time.monotonic()
    assert machine.api.post(f"runs/{run['id']}/cancel").status_code == 202
    assert machine.finish(run)["state"] == "cancelled"
    assert time.monotonic() - asked_s < LEASE_S / 3
    assert {shard.state for shard in machine.shards(run)} <= {ShardState.COMPLETED, ShardState.CANCELLED}


def test_a_worker_that_is_stopped_gives_its_shards_back_before_their_leases_end(machine: Machine) -> None:
    experiment = machine.experiment()
    machine.service.children["worker shards"].stop()
    run = machine.start(experiment)
    extra = subprocess.Popen(
        [sys.executable, "-m", "celery", "-A", "worker.app", "worker", "-Q", "shards", "-c", "1", "-n", "extra@%h"],
        cwd=ROOT,
        env=dict(machine.service.environment) | {"REMAP_SIGTERM": "SIGQUIT"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _await(lambda: _is_at_work(machine, run), timeout_s=90, pause_s=0.02)
    extra.terminate()
    assert extra.wait(timeout=20) is not None
    states = {shard.state for shard in machine.shards(run, "detect")}
    assert ShardState.RUNNING not in states
    assert ShardState.QUEUED in states
    assert max(shard.attempts for shard in machine.shards(run, "detect")) <= 1
    assert machine.api.post(f"runs/{run['id']}/cancel").json()["state"] == "cancelled"
