"""Live progress: told at once, told of changes, told of the end, and nobody is kept waiting."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from queue import Queue

import pytest
from sqlalchemy import text

from tests.house import House, Json


@contextmanager
def _following(house: House, path: str) -> Iterator["Queue[Json | None]"]:
    """What a page hears; None when the stream has ended, which the test brings about."""
    told: Queue[Json | None] = Queue()

    def listen() -> None:
        with house.api.stream("GET", path, timeout=20) as answer:
            assert answer.headers["content-type"].startswith("text/event-stream")
            for line in answer.iter_lines():
                if line.startswith("data: "):
                    told.put(json.loads(line.removeprefix("data: ")))
        told.put(None)

    thread = threading.Thread(target=listen, daemon=True)
    thread.start()
    yield told
    thread.join(timeout=5)
    assert not thread.is_alive()


def test_a_run_is_followed_from_now_to_its_end(house: House) -> None:
    run = house.start(house.ready())
    with _following(house, f"runs/{run['id']}/events") as told:
        first = told.get(timeout=5)
        assert first is not None
        assert first["state"] == "queued"
        house.work()
        heard = [first]
        while (event := told.get(timeout=10)) is not None:
            heard.append(event)
    assert heard[-1] == house.again(run)
    assert heard[-1]["state"] == "completed"


def test_a_run_that_has_ended_is_told_once_and_the_stream_ends(house: House) -> None:
    run = house.start(house.ready())
    house.api.post(f"runs/{run['id']}/cancel")
    with _following(house, f"runs/{run['id']}/events") as told:
        event = told.get(timeout=5)
        assert event is not None
        assert event["state"] == "cancelled"
        assert told.get(timeout=5) is None


def test_an_experiment_is_followed_until_it_is_deleted(house: House) -> None:
    experiment = house.experiment()
    with _following(house, f"experiments/{experiment['id']}/events") as told:
        assert told.get(timeout=5) == experiment
        house.ok(
            house.api.patch(
                f"experiments/{experiment['id']}", json={"experiment": experiment["experiment"] | {"name": "new"}}
            )
        )
        event = told.get(timeout=5)
        assert event is not None
        assert event["experiment"]["name"] == "new"
        house.api.delete(f"experiments/{experiment['id']}")
        assert told.get(timeout=5) is None


def test_many_changes_are_told_at_most_twice_a_second(house: House) -> None:
    experiment = house.experiment()
    with _following(house, f"experiments/{experiment['id']}/events") as told:
        told.get(timeout=5)
        began, number = time.monotonic(), 0
        while number < 12 or time.monotonic() < began + 2.0:
            number += 1
            document = experiment["experiment"] | {"name": f"name {number}"}
            house.ok(house.api.patch(f"experiments/{experiment['id']}", json={"experiment": document}))
        heard = 0
        while (change := told.get(timeout=10)) is not None:
            heard += 1
            if change["experiment"]["name"] == f"name {number}":
                break
        elapsed_s = time.monotonic() - began
        house.api.delete(f"experiments/{experiment['id']}")
    assert change is not None
    assert 2 <= heard <= 2 * elapsed_s + 2


def test_those_who_wait_hold_no_connection_to_the_database(house: House) -> None:
    experiment = house.experiment()
    path = f"experiments/{experiment['id']}/events"
    with _following(house, path) as one, _following(house, path) as two:
        assert one.get(timeout=5) == two.get(timeout=5) == experiment
        time.sleep(0.3)
        with house.context.sessions() as session:
            busy = session.scalar(
                text(
                    "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() "
                    "AND state LIKE 'idle in transaction%'"
                )
            )
        house.api.delete(f"experiments/{experiment['id']}")
    assert busy == 0


@pytest.mark.parametrize("kind", ["runs", "experiments"])
def test_what_is_not_there_is_not_followed(house: House, kind: str) -> None:
    answer = house.api.get(f"{kind}/00000000-0000-4000-8000-000000000009/events")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
