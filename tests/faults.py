"""A whole deployment whose parts are killed, stopped and started again while it works."""

import io
import os
import random
import signal
import threading
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TypeVar
from uuid import UUID

import httpx
import pyarrow as pa
import pyarrow.parquet as pq
import redis
from sqlalchemy import Engine, select
from sqlalchemy.exc import SQLAlchemyError

from backend.models import Run, Shard
from backend.models.states import ACTIVE_RUN_STATES, OPEN_SHARD_STATES, ShardState
from backend.platform.database import make_engine, make_sessions
from backend.platform.queue import QUEUES
from deploy.local.answers import status_of
from deploy.local.folder import InstanceFolder, open_folder
from deploy.local.options import Options
from deploy.local.postgres import Postgres, new_password
from deploy.local.processes import free_port
from deploy.local.services import api, environment_of, workers
from deploy.local.supervisor import Supervisor
from deploy.local.valkey import Valkey
from tests.films import EXPERIMENT, PARAMETERS, frame, tiff
from tests.house import Json
from tests.services import migrate, scratch_folder

T = TypeVar("T")
QUICK = {"LEASE_S": "4", "RECONCILE_EVERY_S": "0.5", "RESEND_AFTER_S": "1", "LOG_LEVEL": "WARNING"}
LONGEST_RESTART_S = 1.0
TABLES = {
    "droplets.parquet": [("frame", "ascending"), ("x_px", "ascending"), ("y_px", "ascending")],
    "trajectories.parquet": [("trajectory_id", "ascending"), ("frame", "ascending")],
    "rejected_trajectories.parquet": [("trajectory_id", "ascending")],
}


@dataclass
class Deployment:
    """Postgres, Valkey, API, workers and reconciler, each of which is started again when it dies."""

    supervisor: Supervisor
    folder: InstanceFolder
    port: int
    redis_url: str
    engine: Engine
    kills: Counter[str] = field(default_factory=Counter)

    def client(self) -> httpx.Client:
        """Speaks to the API."""
        return httpx.Client(base_url=f"http://127.0.0.1:{self.port}/api/v1/", timeout=20)

    def look_after(self, condition: Callable[[], bool], timeout_s: float) -> None:
        """Start again what dies, until a condition holds. Call it from the thread that started it all."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            self.supervisor.check()
            assert time.monotonic() < deadline, f"not within {timeout_s:.0f} s; killed so far: {dict(self.kills)}"
            time.sleep(0.05)

    def kill(self, victim: str) -> bool:
        """Kill a part of this name, or whoever works on a shard of this task, with SIGKILL; False if nobody does."""
        process = self._holder(victim.removeprefix("busy ")) if victim.startswith("busy ") else self.process_of(victim)
        if process is None:
            return False
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
            self.kills[victim] += 1
            return True
        return False

    def process_of(self, name: str) -> int | None:
        """The process of one part, if it runs now."""
        (entry,) = [entry for entry in self.supervisor.supervised if entry.service.name == name]
        return entry.child.process.pid if entry.start_again_at is None and entry.child.is_running else None

    def shards(self, *conditions: object) -> list[Shard]:
        """Shards that fulfil conditions."""
        with make_sessions(self.engine)() as session:
            return list(session.scalars(select(Shard).where(*conditions).order_by(Shard.start_frame)))  # type: ignore[arg-type]

    def forget_messages(self) -> None:
        """Empty the broker."""
        with suppress(redis.RedisError), redis.Redis.from_url(self.redis_url, socket_timeout=2) as broker:
            broker.flushall()

    def double_messages(self) -> int:
        """Put a second one behind each message that waits. Returns how many there were."""
        n_doubled = 0
        with redis.Redis.from_url(self.redis_url) as broker:
            for queue in QUEUES:
                for message in broker.lrange(queue, 0, -1):  # type: ignore[union-attr]
                    broker.lpush(queue, message)
                    n_doubled += 1
        return n_doubled

    def open_work(self) -> tuple[int, int]:
        """How many runs and shards have not ended."""
        with make_sessions(self.engine)() as session:
            runs = session.scalars(select(Run.id).where(Run.state.in_(ACTIVE_RUN_STATES))).all()
            shards = session.scalars(select(Shard.id).where(Shard.state.in_(OPEN_SHARD_STATES))).all()
        return len(runs), len(shards)

    def _holder(self, task: str) -> int | None:
        with suppress(SQLAlchemyError):
            held = self.shards(Shard.state == ShardState.RUNNING, Shard.task == task)
            if held:
                return int(str(random.choice(held).holder).rpartition(":")[2])
        return None


@contextmanager
def deployment(**settings: str) -> Iterator[Deployment]:
    """Start everything in a folder of its own; the servers keep on disk what they would keep anywhere."""
    supervisor = Supervisor(lambda _: None, longest_delay_s=LONGEST_RESTART_S)
    options = Options(port=free_port())
    with scratch_folder() as scratch, open_folder(Options(port=options.port, data=scratch)) as folder:
        postgres = Postgres(scratch / "postgres", password=new_password(), log=folder.log("postgres"))
        valkey = Valkey(scratch / "valkey", password=new_password(), log=folder.log("valkey"))
        engine = None
        try:
            for server in (postgres, valkey):
                supervisor.start(server, tier=0)
            postgres.create_database("dropflow")
            url = postgres.url("dropflow")
            migrate(url)
            engine = make_engine(url, application="test")
            variables = environment_of(options, folder, database_url=url, redis_url=valkey.url()) | QUICK | settings
            for program in (api(folder, variables), *workers(folder, variables)):
                supervisor.start(program, tier=1)
            made = Deployment(supervisor, folder, options.port, valkey.url(), engine)
            made.look_after(lambda: status_of(options.port, "/api/v1/health") == 200, 180)
            yield made
        finally:
            if engine is not None:
                engine.dispose()
            supervisor.stop()


class Customer:
    """Somebody who uploads a film and has it analysed, and does not give up when the service is away."""

    def __init__(self, api: httpx.Client, *, n_frames: int, shape: tuple[int, int], patience_s: float) -> None:
        self._api, self._patience_s = api, patience_s
        self._content = tiff(*(frame(index, shape) for index in range(n_frames)))

    def analyse(self) -> Json:
        """One experiment from the upload to the end of its run."""
        experiment = self._until(lambda: self._api.post("experiments", json={"experiment": EXPERIMENT}))
        place = f"experiments/{experiment['id']}"
        # Each step is asked for again until the state says that it was done: an answer may get lost on the way.
        while (stack := self._get(place)["stack"])["state"] != "ready":
            assert stack["state"] != "rejected", stack["problem"]
            if stack["state"] in {"empty", "uploading"}:
                self._try(lambda: self._api.put(f"{place}/files", params={"name": "film.tif"}, content=self._content))
                self._try(lambda: self._api.post(f"{place}/stack"))
            time.sleep(0.1)
        while not (runs := self._get(f"{place}/runs")["items"]):
            self._try(lambda: self._api.post(f"{place}/runs", json={"parameters": PARAMETERS}))
        run: Json = runs[0]
        while (now := self._get(f"runs/{run['id']}"))["state"] in {"queued", "running"}:
            time.sleep(0.1)
        return now

    def file(self, run: Json, name: str) -> bytes:
        """A file of a run's results."""
        return self._answer(lambda: self._api.get(f"runs/{run['id']}/files/{name}")).content

    def digest(self, run: Json) -> dict[str, bytes]:
        """The results as bytes: tables sorted, the flow field file by file, the summary."""
        found = {}
        for name, order in TABLES.items():
            table = pq.read_table(io.BytesIO(self.file(run, name))).sort_by(order)
            packed = io.BytesIO()
            with pa.ipc.new_stream(packed, table.schema) as writer:
                writer.write_table(table.combine_chunks())
            found[name] = packed.getvalue()
        with zipfile.ZipFile(io.BytesIO(self.file(run, "flow.zarr.zip"))) as flow:
            found |= {member: flow.read(member) for member in sorted(flow.namelist())}
        return found | {"summary.json": self.file(run, "summary.json")}

    def _get(self, path: str) -> Json:
        return self._until(lambda: self._api.get(path))

    def _until(self, ask: Callable[[], httpx.Response]) -> Json:
        body: Json = self._answer(ask).json()
        return body

    def _answer(self, ask: Callable[[], httpx.Response]) -> httpx.Response:
        deadline = time.monotonic() + self._patience_s
        while (answer := self._try(ask)) is None or answer.status_code >= 500:
            assert time.monotonic() < deadline, "the service stayed away"
            time.sleep(0.1)
        assert answer.status_code < 400, answer.text
        return answer

    @staticmethod
    def _try(ask: Callable[[], httpx.Response]) -> httpx.Response | None:
        with suppress(httpx.TransportError):
            return ask()
        return None


class InThread(threading.Thread):
    """Work beside the test, whose error the test sees."""

    def __init__(self, work: Callable[[], None]) -> None:
        super().__init__(daemon=True)
        self._work = work
        self.error: BaseException | None = None
        self.start()

    def run(self) -> None:
        try:
            self._work()
        except BaseException as error:
            self.error = error


def run_id(run: Json) -> UUID:
    """Of a run as the API shows it."""
    return UUID(run["id"])
