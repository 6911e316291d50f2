"""Who may reach the service: without accounts its own machine alone, else nobody before somebody governs it."""

import asyncio
import subprocess
import sys

import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from backend.platform.origins import LocalOnly, OpenDoor, refuse_open_door
from backend.platform.settings import Settings
from tests.house import open_house
from tests.lab import lab_settings, open_lab
from tests.services import ROOT

ELSEWHERE = ("0.0.0.0", "::", "192.168.1.5", "example.org")  # noqa: S104 - that is what is refused


@pytest.mark.parametrize("host", ELSEWHERE)
def test_a_server_without_accounts_is_not_started_for_all_the_world(host: str) -> None:
    for arguments, environment in (
        (["uvicorn", "--host", host], {}),
        (["uvicorn", f"--host={host}"], {}),
        (["uvicorn"], {"UVICORN_HOST": host}),
    ):
        with pytest.raises(OpenDoor, match="AUTH=accounts"):
            refuse_open_door(arguments, environment)


def test_a_server_without_accounts_is_started_for_this_machine() -> None:
    for host in ("127.0.0.1", "localhost", "::1"):
        refuse_open_door(["uvicorn", "--host", host], {})
    refuse_open_door(["uvicorn"], {})


def test_uvicorn_by_hand_is_refused_before_it_listens(settings: Settings) -> None:
    given = settings.model_dump(mode="json")
    environment = {name.upper(): str(given[name]) for name in ("database_url", "redis_url", "object_store_url")}
    command = ["-m", "uvicorn", "backend.app:create_app", "--factory", "--host", "0.0.0.0", "--port", "0"]  # noqa: S104
    done = subprocess.run(
        [sys.executable, *command], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode != 0
    assert "nobody but this machine may reach the service" in done.stderr
    assert "running on" not in done.stderr


def test_what_comes_in_from_elsewhere_is_refused_whatever_it_says() -> None:
    async def answers(scope: Scope, receive: Receive, send: Send) -> None:
        await PlainTextResponse("inside")(scope, receive, send)

    def ask(came_in: tuple[str, int | None]) -> int:
        told: list[Message] = []

        async def send(message: Message) -> None:
            told.append(message)

        headers = [(b"host", b"127.0.0.1:8000")]
        scope = {"type": "http", "method": "GET", "path": "/", "headers": headers, "server": came_in}
        asyncio.run(LocalOnly(answers)(scope, never, send))
        return int(told[0]["status"])

    assert ask(("127.0.0.1", 8000)) == ask(("::1", 8000)) == ask(("/run/dropflow.sock", None)) == 200
    assert ask(("192.168.1.5", 8000)) == ask(("2001:db8::1", 8000)) == 403


async def never() -> Message:
    raise AssertionError("nothing is read of it")


def test_a_service_with_accounts_is_closed_until_it_has_an_administrator(settings: Settings) -> None:
    given = lab_settings(settings)
    with open_house(given) as house:
        closed = house.api.get("session")
        assert (closed.status_code, closed.json()["code"]) == (503, "service.no_administrator")
        tried = house.api.post("session", json={"email": "a@b", "password": "c"})
        assert tried.json()["code"] == "service.no_administrator"
        assert house.api.get("health").status_code == 200
        with open_lab(given):
            pass
        assert house.api.get("session").status_code == 200
