"""Idempotency-Key: asked for twice, created once."""

from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta

import httpx
import pytest
from sqlalchemy import func, select, update

from backend.models import IdempotencyKey, Shard
from tests.films import EXPERIMENT
from tests.house import House, Json

KEY = {"Idempotency-Key": "film-of-monday"}


def _create(house: House, headers: dict[str, str] = KEY, **changes: object) -> httpx.Response:
    return house.api.post("experiments", json={"experiment": {**EXPERIMENT, **changes}}, headers=headers)


def _n_experiments(house: House) -> int:
    return len(house.ok(house.api.get("experiments"))["items"])


def test_the_same_request_again_is_answered_with_what_it_made(house: House) -> None:
    first = _create(house)
    assert first.status_code == 201
    assert "idempotency-replayed" not in first.headers
    again = _create(house)
    assert (again.status_code, again.json()) == (201, first.json())
    assert again.headers["idempotency-replayed"] == "true"
    assert _n_experiments(house) == 1


def test_the_same_json_in_another_order_is_the_same_request(house: House) -> None:
    first = _create(house)
    backwards = {"experiment": dict(reversed(EXPERIMENT.items()))}
    assert house.api.post("experiments", json=backwards, headers=KEY).json() == first.json()


def test_another_key_or_none_creates_another(house: House) -> None:
    ids = {_create(house, headers).json()["id"] for headers in (KEY, {"Idempotency-Key": "other"}, {}, {})}
    assert len(ids) == 4


def test_a_key_with_another_body_or_for_another_call_is_refused(house: House) -> None:
    ready = house.ready()
    _create(house)
    runs = house.api.post(f"experiments/{ready['id']}/runs", json={"parameters": {}}, headers=KEY)
    for answer in (_create(house, name="another"), runs):
        assert answer.status_code == 422
        assert answer.json()["code"] == "idempotency.other_request"
    assert _n_experiments(house) == 2


def test_what_was_refused_leaves_its_key_free(house: House) -> None:
    assert _create(house, droplets="blue").status_code == 422
    assert _create(house).status_code == 201


def test_what_was_deleted_is_not_made_again(house: House) -> None:
    made = _create(house).json()
    house.api.delete(f"experiments/{made['id']}")
    answer = _create(house)
    assert (answer.status_code, answer.json()["code"]) == (409, "idempotency.deleted")


def test_many_at_once_create_one(house: House) -> None:
    with ThreadPoolExecutor(12) as pool:
        answers = list(pool.map(lambda _: _create(house), range(24)))
    assert {answer.status_code for answer in answers} == {201}
    assert len({answer.json()["id"] for answer in answers}) == 1
    assert sum("idempotency-replayed" not in answer.headers for answer in answers) == 1
    assert _n_experiments(house) == 1


def test_a_run_asked_for_twice_is_one_run_with_one_shard(house: House) -> None:
    ready = house.ready()
    path, body = f"experiments/{ready['id']}/runs", {"parameters": {}}
    first, again = (house.ok(house.api.post(path, json=body, headers=KEY), 202) for _ in range(2))
    assert first["id"] == again["id"]
    with house.context.sessions() as session:
        assert session.scalar(select(func.count()).where(Shard.run_id == first["id"])) == 1


def test_a_failed_run_retried_twice_with_one_key_is_one_new_run(house: House) -> None:
    ready = house.ready()
    run = _failed(house, house.start(ready))
    first, again = (house.ok(house.api.post(f"runs/{run['id']}/retry", headers=KEY), 202) for _ in range(2))
    assert first["id"] == again["id"] != run["id"]
    assert house.again(ready)["n_runs"] == 2


def _failed(house: House, run: Json) -> Json:
    for file in house.objects.rglob("files/*"):
        file.write_bytes(b"broken since it was indexed")
    house.work()
    failed = house.again(run)
    assert failed["state"] == "failed"
    return failed


@pytest.mark.parametrize("key", ["", "x" * 256, "with space", "ü".encode("latin-1")])
def test_a_key_that_is_none_is_refused(house: House, key: str | bytes) -> None:
    body = {"experiment": EXPERIMENT}
    answer = house.api.post("experiments", json=body, headers=httpx.Headers({b"Idempotency-Key": key}))  # type: ignore[dict-item]
    assert answer.status_code == 422
    assert "idempotency-key" in answer.json()["errors"][0]["field"]


def test_keys_are_forgotten_after_a_month(house: House) -> None:
    _create(house)
    with house.context.sessions.begin() as session:
        session.execute(update(IdempotencyKey).values(created_at=datetime.now(UTC) - timedelta(days=31)))
    _create(house, {"Idempotency-Key": "new"})
    with house.context.sessions() as session:
        assert session.scalars(select(IdempotencyKey.key)).all() == ["new"]
