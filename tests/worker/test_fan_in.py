"""The last shard begins what follows, exactly once, whoever brings it and however often."""

import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import pytest

from backend.models.states import ShardState
from tests.house import House, Json
from worker.context import Context, make_context
from worker.shards import look_at


@pytest.fixture
def run(house: House) -> Json:
    run = house.start(house.ready())
    look_at(house.context, house.waiting("prepare")[0])
    return run


def _tasks(house: House, run: Json) -> Counter[str]:
    return Counter(shard.task for shard in house.shards(run))


def test_whoever_of_two_comes_last_begins_tracking_and_only_that_one(house: House, run: Json) -> None:
    *others, one, two = house.waiting("detect")
    for shard_id in others:
        look_at(house.context, shard_id)
    contexts: list[Context] = [make_context(house.context.settings) for _ in range(2)]
    start = threading.Barrier(2)

    def bring(context: Context, shard_id: object) -> None:
        start.wait()
        look_at(context, shard_id)  # type: ignore[arg-type]

    try:
        with ThreadPoolExecutor(2) as pool:
            for done in [pool.submit(bring, *work) for work in zip(contexts, (one, two), strict=True)]:
                done.result()
    finally:
        for context in contexts:
            context.close()
    assert _tasks(house, run) == {"prepare": 1, "detect": 6, "track": 1}


def test_every_message_twice_changes_nothing(house: House, run: Json) -> None:
    while waiting := house.waiting():
        for shard_id in [*waiting, *waiting]:
            look_at(house.context, shard_id)
    assert house.again(run)["state"] == "completed"
    assert _tasks(house, run) == {"prepare": 1, "detect": 6, "track": 1, "analyse": 1}
    assert all(shard.attempts == 1 for shard in house.shards(run))


def test_a_message_about_nothing_changes_nothing(house: House, run: Json) -> None:
    before = [(shard.id, shard.state) for shard in house.shards(run)]
    done = house.shards(run)[0]
    assert done.state == ShardState.COMPLETED
    look_at(house.context, done.id)
    look_at(house.context, run["id"])
    assert [(shard.id, shard.state) for shard in house.shards(run)] == before


def test_shards_in_any_order_give_the_same(house: House, run: Json) -> None:
    for shard_id in reversed(house.waiting("detect")):
        look_at(house.context, shard_id)
    house.work()
    backwards = house.again(run)
    first = house.again(house.start(house.ready()))
    house.work()
    forwards = house.again(first)
    assert backwards["state"] == forwards["state"] == "completed"
    assert backwards["summary"] == forwards["summary"]
