"""Every error is a problem document that says what, where and what to do, and nothing of our insides."""

import asyncio
import json
from collections.abc import Iterator
from contextlib import contextmanager

import psycopg
import pytest

from backend.app import create_app
from backend.platform.dependencies import get_platform
from backend.platform.settings import Settings
from deploy.local.postgres import Postgres, plain
from tests.films import EXPERIMENT
from tests.house import House

PARTS = {"type", "title", "status", "code", "detail", "errors", "file", "frame", "hint"}
JSON = {"Content-Type": "application/json"}


@pytest.mark.parametrize(
    ("method", "path", "content", "status", "code"),
    [
        ("GET", "nothing/here", "", 404, "not_found"),
        ("GET", "experiments/1", "", 422, "request.invalid"),
        ("GET", "runs/00000000-0000-4000-8000-000000000000", "", 404, "not_found.run"),
        ("PUT", "health", "", 405, "request.method_not_allowed"),
        ("POST", "experiments", "{", 422, "request.invalid"),
        ("POST", "experiments", "[]", 422, "request.invalid"),
        ("POST", "experiments", "[" * 100_000, 400, "request.invalid"),
        ("POST", "experiments", '{"experiment": {}, "more": 1}', 422, "request.invalid"),
        ("POST", "experiments", '{"experiment": {}}', 422, "experiment.invalid"),
        ("POST", "experiments", json.dumps({"experiment": {"notes": "x" * 2_000_000}}), 413, "request.too_large"),
        ("GET", "experiments?limit=0", "", 422, "request.invalid"),
        ("GET", "experiments?limit=9999999999999999999999", "", 422, "request.invalid"),
    ],
)
def test_an_error_is_a_problem(house: House, method: str, path: str, content: str, status: int, code: str) -> None:
    answer = house.api.request(method, path, content=content, headers=JSON)
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert set(problem) == PARTS
    assert (answer.status_code, problem["status"], problem["code"]) == (status, status, code)
    assert problem["detail"]


@pytest.mark.parametrize(
    ("method", "path", "headers", "status", "code"),
    [
        ("GET", "experiments", {"Accept": "text/html"}, 406, "request.not_acceptable"),
        ("GET", "experiments", {"Accept": "application/json;q=0"}, 406, "request.not_acceptable"),
        ("GET", "experiments", {"Accept": "text/html, application/*;q=0.1"}, 200, ""),
        ("GET", "experiments", {"Accept": "*/*"}, 200, ""),
        ("POST", "experiments", {"Accept": "image/webp"}, 406, "request.not_acceptable"),
        ("POST", "experiments", {"Content-Type": "text/plain"}, 415, "request.unsupported_media_type"),
        (
            "POST",
            "experiments",
            {"Content-Type": "application/x-www-form-urlencoded"},
            415,
            "request.unsupported_media_type",
        ),
        ("POST", "experiments", {"Content-Type": ""}, 415, "request.unsupported_media_type"),
        ("POST", "experiments", {"Content-Type": "application/json; charset=utf-8"}, 201, ""),
    ],
)
def test_only_what_a_call_takes_and_gives_is_taken_and_given(
    house: House, method: str, path: str, headers: dict[str, str], status: int, code: str
) -> None:
    content = json.dumps({"experiment": EXPERIMENT}) if method == "POST" else ""
    answer = house.api.request(method, path, content=content, headers={"Content-Type": "application/json"} | headers)
    assert answer.status_code == status
    assert answer.json().get("code", "") == code
    assert (len(house.ok(house.api.get("experiments"))["items"]) == 1) is (status == 201)


def test_a_call_that_is_none_is_told_those_that_are(house: House) -> None:
    answer = house.api.put("experiments/5f0c6a2e-8f5d-4b7e-9a53-0b1d2c3e4f50")
    assert answer.status_code == 405
    assert answer.headers["allow"] == "DELETE, GET, PATCH"


def test_numbers_that_are_none_are_refused(house: House) -> None:
    for number in ("NaN", "Infinity", "1e999"):
        text = json.dumps({"experiment": EXPERIMENT}).replace("1.0,", f"{number},", 1)
        assert number in text
        answer = house.api.post("experiments", content=text, headers=JSON)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["field"] == "pixel_size_um"


def test_a_body_of_unknown_length_is_bounded_too(house: House) -> None:
    answer = house.api.post("experiments", content=(b" " * 100_000 for _ in range(20)), headers=JSON)
    assert answer.status_code == 413


def test_a_bug_is_answered_without_its_trace(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> None:
        raise RuntimeError("a secret")

    monkeypatch.setitem(house.app.dependency_overrides, get_platform, broken)
    answer = house.api.get("health")
    assert answer.status_code == 500
    assert answer.json()["code"] == "service.internal"
    assert "secret" not in answer.text


def test_while_the_database_is_away_the_service_says_so_and_goes_on_after(
    house: House, postgres_server: Postgres
) -> None:
    experiment = house.experiment()
    with _away(house, postgres_server):
        health, read = house.api.get("health"), house.api.get(f"experiments/{experiment['id']}")
    for answer in (health, read):
        assert answer.status_code == 503
        assert answer.json()["code"] == "service.database_away"
        assert answer.headers["content-type"] == "application/problem+json"
    assert house.api.get("health").status_code == 200
    assert house.again(experiment) == experiment


@contextmanager
def _away(house: House, server: Postgres) -> Iterator[None]:
    name = house.context.settings.database_url.rpartition("/")[2]
    with psycopg.connect(plain(server.url()), autocommit=True) as admin:
        admin.execute(f'ALTER DATABASE "{name}" ALLOW_CONNECTIONS false')
        admin.execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = %s", [name])
        yield
        admin.execute(f'ALTER DATABASE "{name}" ALLOW_CONNECTIONS true')


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "https://127.0.0.1.evil.example", "null", "http://10.0.0.1:80"]
)
def test_other_pages_of_the_same_browser_are_refused(house: House, origin: str) -> None:
    for headers in ({"Origin": origin}, {"Host": origin.removeprefix("http://").removeprefix("https://")}):
        answer = house.api.post("experiments", json={"experiment": EXPERIMENT}, headers=headers)
        assert answer.status_code == 403
        assert answer.json()["code"] == "request.foreign_origin"
    assert house.ok(house.api.get("experiments"))["items"] == []


@pytest.mark.parametrize("origin", ["http://localhost:5173", "http://127.0.0.1:8000", "http://[::1]:1"])
def test_pages_of_this_machine_are_served(house: House, origin: str) -> None:
    assert house.api.get("health", headers={"Origin": origin}).status_code == 200


def test_a_service_whose_database_is_not_migrated_says_what_to_do(settings: Settings, empty_database_url: str) -> None:
    app = create_app(settings.model_copy(update={"database_url": empty_database_url}))

    async def start() -> None:
        async with app.router.lifespan_context(app):
            pass

    with pytest.raises(RuntimeError, match="alembic upgrade head"):
        asyncio.run(start())


def test_what_is_no_json_is_said_of_the_body_and_not_of_a_number(house: House) -> None:
    answer = house.api.post("experiments", content='{"experiment": ', headers=JSON)
    (found,) = answer.json()["errors"]
    assert found["field"] == "body"
    assert found["message"].startswith("is not JSON: ")
    assert found["message"].endswith("at character 15")
