"""A server of the first version: the service, without all that 1.1 added."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.app import create_app
from backend.platform.problems import NotFound, problem_of, problem_response
from backend.platform.settings import Settings
from deploy.local.postgres import Postgres
from dropflow.client import Client, NotReachable, WrongVersion
from tests.films import PARAMETERS
from tests.house import House, house_settings, open_house

LATER_HEADERS = {b"idempotency-key", b"range", b"if-range", b"if-match", b"if-none-match"}
LATER_ANSWERS = {b"etag", b"repr-digest", b"accept-ranges", b"idempotency-replayed", b"content-length"}


class FirstVersion:
    """Knows no call, header or field that was added later."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        path = scope["path"].removeprefix("/api/v1/")
        if path == "runs" or "/uploads" in path or scope["query_string"].startswith((b"q=", b"state=")):
            await problem_response(problem_of(NotFound("There is nothing here.")))(scope, receive, send)
            return
        scope = {**scope, "headers": [(name, value) for name, value in scope["headers"] if name not in LATER_HEADERS]}

        async def as_then(message: Message) -> None:
            if message["type"] == "http.response.start":
                kept = [(name, value) for name, value in message["headers"] if name.lower() not in LATER_ANSWERS]
                message = {**message, "headers": kept}
            elif path == "health":
                said = json.loads(message["body"])
                del said["api_version"]
                message = {**message, "body": json.dumps(said).encode()}
            await send(message)

        await self._app(scope, receive, as_then)


@pytest.fixture
def first_house(database_url: str, redis_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[House]:
    def create_first(settings: Settings) -> FastAPI:
        app = create_app(settings)
        app.add_middleware(FirstVersion)
        return app

    monkeypatch.setattr("tests.house.create_app", create_first)
    with open_house(house_settings(database_url, redis_url, tmp_path / "house")) as house:
        yield house


def test_it_is_used_as_far_as_it_goes_and_says_why_not_further(
    first_house: House, stack: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DROPFLOW_CONFIG", str(tmp_path / "servers.yaml"))
    address = str(first_house.api.base_url).removesuffix("api/v1/")
    with Client(address) as client:
        assert str(client.version) == "1.0"
        experiment = client.experiments.create(stack.parent / "experiment.yaml")
        experiment.upload(stack, beside=stack.parent)
        assert [file.name for file in experiment.files()] == [f"frame{index}.tif" for index in range(6)]
        first_house.work()
        run = experiment.wait_ready(timeout_s=60).start(PARAMETERS)
        first_house.work()
        assert run.wait(timeout_s=60).trajectories().height > 0
        assert run.flow()["velocity_um_s"].ndim == 4
        assert [found.id for found in experiment.runs()] == [run.id]
        assert [found.id for found in client.experiments.list()] == [experiment.id]
        with pytest.raises(WrongVersion, match=r"came with 1\.1"):
            next(client.runs.list())
        with pytest.raises(WrongVersion, match=r"filters of lists came with 1\.1"):
            next(client.experiments.list(q="film"))


def test_submitting_again_makes_no_double_though_the_server_cannot_tell(
    first_house: House, stack: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DROPFLOW_CONFIG", str(tmp_path / "servers.yaml"))
    description = stack.parent / "experiment.yaml"
    with Client(str(first_house.api.base_url).removesuffix("api/v1/")) as client, working(first_house):
        killed = client.experiments.create(description)  # and nothing was sent yet
        first = client.submit(stack, description, parameters=PARAMETERS)
        again = client.submit(stack, description, parameters=PARAMETERS)
        assert (first.document.experiment_id, again.id) == (killed.id, first.id)
        assert len(list(client.experiments.list())) == 1
        other = {**PARAMETERS, "flow": {"n_columns": 4, "n_rows": 4}}
        assert client.submit(stack, description, parameters=other).id != first.id


@contextmanager
def working(house: House) -> Iterator[None]:
    """A worker that works by itself."""
    end = threading.Event()

    def work() -> None:
        while not end.wait(0.1):
            house.work()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        end.set()
        thread.join()


def test_what_is_no_dropflow_is_told_by_its_answer(postgres_server: Postgres) -> None:
    """Another program of this machine, which speaks no HTTP."""
    with pytest.raises(NotReachable):
        Client(f"http://127.0.0.1:{postgres_server.port}/")
