"""The service in this process: the API on a real port in a thread, and a worker whose work is done when a test says so.

Postgres, Valkey and the folder of objects are real; only that nothing happens by itself makes it quick and exact.
`tests.services.running_service` is the same as processes that work on their own.
"""

import shutil
import socket
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from uuid import UUID

import httpx
import redis
import uvicorn
from fastapi import FastAPI
from sqlalchemy import select, text

from backend.app import create_app
from backend.models import Shard
from backend.models.states import ShardState
from backend.platform.settings import Settings
from tests.films import EXPERIMENT, PARAMETERS, Upload, film
from worker.context import Context, make_context
from worker.reconcile import remove_doomed
from worker.shards import look_at

Json = dict[str, Any]


@dataclass(frozen=True)
class House:
    """A running API, and the parts of a worker."""

    app: FastAPI
    api: httpx.Client
    context: Context
    objects: Path

    def empty(self) -> None:
        """Forget everything but the people."""
        with self.context.sessions.begin() as session:
            session.execute(text("TRUNCATE experiment, doomed_object, idempotency_key, preset CASCADE"))
        shutil.rmtree(self.objects / "experiments", ignore_errors=True)
        with redis.Redis.from_url(self.context.settings.redis_url) as broker:
            broker.flushdb()

    def experiment(self, **changes: Any) -> Json:
        """A new experiment without frames."""
        return self.ok(self.api.post("experiments", json={"experiment": {**EXPERIMENT, **changes}}), 201)

    def upload(self, experiment: Json, *files: Upload) -> None:
        """Upload files one after the other."""
        for file in files:
            self.ok(self.put(experiment, file), 201)

    def put(self, experiment: Json, file: Upload) -> httpx.Response:
        """Upload one file."""
        about = {"name": file.name, "role": file.role}
        return self.api.put(f"experiments/{experiment['id']}/files", params=about, content=file.content)

    def seal(self, experiment: Json) -> Json:
        """Say that the upload is complete, and have it indexed."""
        self.ok(self.api.post(f"experiments/{experiment['id']}/stack"), 202)
        self.work()
        return self.again(experiment)

    def ready(self, files: Sequence[Upload] | None = None, **changes: Any) -> Json:
        """A new experiment whose frames are indexed."""
        experiment = self.experiment(**changes)
        self.upload(experiment, *(film() if files is None else files))
        ready = self.seal(experiment)
        assert ready["stack"]["state"] == "ready", ready["stack"]["problem"]
        return ready

    def start(self, experiment: Json, parameters: Json | None = None) -> Json:
        """A new run, queued."""
        body = {"parameters": PARAMETERS if parameters is None else parameters}
        return self.ok(self.api.post(f"experiments/{experiment['id']}/runs", json=body), 202)

    def again(self, thing: Json) -> Json:
        """The same experiment or run as it is now."""
        kind = "runs" if "experiment_id" in thing else "experiments"
        return self.ok(self.api.get(f"{kind}/{thing['id']}"))

    def work(self) -> None:
        """Do every shard that waits, and what follows from it."""
        while waiting := self.waiting():
            for shard_id in waiting:
                look_at(self.context, shard_id)

    def waiting(self, task: str | None = None) -> list[UUID]:
        """Shards that nobody has claimed, in the order in which they came."""
        query = select(Shard.id).where(Shard.state == ShardState.QUEUED).order_by(Shard.created_at, Shard.start_frame)
        with self.context.sessions() as session:
            return list(session.scalars(query if task is None else query.where(Shard.task == task)))

    def shards(self, run: Json) -> list[Shard]:
        """All shards of a run."""
        query = select(Shard).where(Shard.run_id == UUID(run["id"])).order_by(Shard.created_at, Shard.start_frame)
        with self.context.sessions() as session:
            return list(session.scalars(query))

    def kept_objects(self) -> list[str]:
        """Every object, after what is doomed was removed."""
        remove_doomed(self.context)
        return sorted(path.relative_to(self.objects).as_posix() for path in self.objects.rglob("*") if path.is_file())

    @staticmethod
    def ok(answer: httpx.Response, status: int = 200) -> Json:
        """The body of an answer that must have this status."""
        assert answer.status_code == status, answer.text
        body: Json = answer.json()
        return body


def house_settings(database_url: str, redis_url: str, folder: Path) -> Settings:
    """Settings of a service that keeps everything in `folder`."""
    return Settings(
        database_url=database_url,
        redis_url=redis_url,
        object_store_url=(folder / "objects").as_uri(),
        work_dir=folder / "work",
        frontend_dist=folder / "dist",
        log_level="ERROR",
    )


@contextmanager
def open_house(settings: Settings) -> Iterator[House]:
    """Serve on a free port until the context ends."""
    app = create_app(settings)
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    context = make_context(settings)
    address = f"http://127.0.0.1:{listening.getsockname()[1]}/api/v1/"
    try:
        while not server.started:
            assert thread.is_alive()
            time.sleep(0.01)
        with httpx.Client(base_url=address, timeout=30) as api:
            yield House(app, api, context, Path(settings.object_store_url.removeprefix("file://")))
    finally:
        app.state.platform.listener.let_go()
        server.should_exit = True
        thread.join()
        context.close()
