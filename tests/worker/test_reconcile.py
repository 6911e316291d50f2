"""What messages and workers lose is found again."""

from datetime import timedelta
from uuid import UUID

import pytest
import redis
from sqlalchemy import func, text, update

from backend.models import DoomedObject, Shard
from backend.models.states import ShardState
from backend.platform.queue import QUEUE_OF_TASK, Queue
from tests.films import film
from tests.house import House, Json
from worker.context import Context
from worker.leases import MAX_ATTEMPTS, claim
from worker.reconcile import reconcile
from worker.shards import look_at


@pytest.fixture
def run(house: House) -> Json:
    run = house.start(house.ready())
    _forget_messages(house)
    look_at(house.context, house.waiting("prepare")[0])
    return run


def _n_messages(house: House, task: str) -> int:
    with redis.Redis.from_url(house.context.settings.redis_url) as broker:
        return int(broker.llen(QUEUE_OF_TASK[task]))  # type: ignore[arg-type]


def _forget_messages(house: House) -> None:
    with redis.Redis.from_url(house.context.settings.redis_url) as broker:
        broker.flushdb()


def _hold_and_fall_silent(house: House, shard_id: UUID) -> None:
    with house.context.sessions.begin() as session:
        assert claim(session, shard_id, holder="gone", lease_s=60) is not None
        past = func.clock_timestamp() - timedelta(seconds=1)
        session.execute(update(Shard).where(Shard.id == shard_id).values(lease_until=past))


def _age(house: House, seconds: float) -> None:
    """Let time pass for what waits."""
    ago = timedelta(seconds=seconds)
    with house.context.sessions.begin() as session:
        session.execute(update(Shard).values(created_at=Shard.created_at - ago, sent_at=Shard.sent_at - ago))


def _shard(house: House, shard_id: UUID) -> Shard:
    with house.context.sessions() as session:
        return session.get_one(Shard, shard_id)


def test_every_shard_that_waits_was_told_of_once(house: House, run: Json) -> None:
    assert _n_messages(house, "detect") == 6
    reconcile(house.context)
    assert _n_messages(house, "detect") == 6


def test_lost_messages_are_sent_again_but_not_at_once_and_not_twice(house: House, run: Json) -> None:
    _forget_messages(house)
    reconcile(house.context)
    assert _n_messages(house, "detect") == 0
    _age(house, house.context.settings.resend_after_s + 1)
    reconcile(house.context)
    assert _n_messages(house, "detect") == 6
    _forget_messages(house)
    reconcile(house.context)
    assert _n_messages(house, "detect") == 0


def test_the_shard_of_a_silent_worker_goes_to_another(house: House, run: Json) -> None:
    shard_id = house.waiting("detect")[0]
    _hold_and_fall_silent(house, shard_id)
    _forget_messages(house)
    reconcile(house.context)
    kept = _shard(house, shard_id)
    assert (kept.state, kept.holder, kept.attempts) == (ShardState.QUEUED, None, 1)
    assert _n_messages(house, "detect") == 1
    house.work()
    assert house.again(run)["state"] == "completed"


def test_a_shard_that_silences_every_worker_fails_the_run_and_says_where(house: House, run: Json) -> None:
    shard_id = house.waiting("detect")[2]
    for _ in range(MAX_ATTEMPTS):
        _hold_and_fall_silent(house, shard_id)
        reconcile(house.context)
    failed = house.again(run)
    assert failed["state"] == "failed"
    assert failed["problem"]["code"] == "run.worker_lost"
    assert "detect" in failed["problem"]["detail"]
    assert house.waiting() == []


def test_a_silent_worker_does_not_keep_a_run_from_being_cancelled(house: House, run: Json) -> None:
    _hold_and_fall_silent(house, house.waiting("detect")[0])
    assert house.ok(house.api.post(f"runs/{run['id']}/cancel"), 202)["state"] == "running"
    reconcile(house.context)
    assert house.again(run)["state"] == "cancelled"


def test_an_index_that_silences_every_worker_rejects_the_stack_but_keeps_its_files(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film())
    house.ok(house.api.post(f"experiments/{experiment['id']}/stack"), 202)
    (shard_id,) = house.waiting()
    for _ in range(MAX_ATTEMPTS):
        _hold_and_fall_silent(house, shard_id)
        reconcile(house.context)
    stack = house.again(experiment)["stack"]
    assert (stack["state"], stack["problem"]["code"], stack["n_files"]) == ("rejected", "run.worker_lost", 6)


def test_doomed_objects_are_removed_and_missing_ones_are_no_trouble(house: House) -> None:
    house.context.store.put("experiments/x/one", b"1")
    house.context.store.put("experiments/x/many/a", b"2")
    house.context.store.put("experiments/x/many/b/c", b"3")
    with house.context.sessions.begin() as session:
        keys = ("experiments/x/one", "experiments/x/many/", "experiments/x/gone", "experiments/y/")
        session.add_all([DoomedObject(key=key) for key in keys])
    reconcile(house.context)
    assert [path for path in house.objects.rglob("*") if path.is_file()] == []
    with house.context.sessions() as session:
        assert session.query(DoomedObject).count() == 0


def test_one_reconciler_works_at_a_time(house: House) -> None:
    house.context.store.put("experiments/x/one", b"1")
    with house.context.sessions.begin() as session:
        session.add(DoomedObject(key="experiments/x/one"))
    with house.context.engine.connect() as other:
        other.execute(text("SELECT pg_advisory_xact_lock(hashtext('dropflow.reconcile'))"))
        reconcile(house.context)
        assert (house.objects / "experiments/x/one").exists()
    reconcile(house.context)
    assert not (house.objects / "experiments/x/one").exists()


def test_without_a_broker_the_rest_is_put_right(house: House, run: Json) -> None:
    shard_id = house.waiting("detect")[0]
    _hold_and_fall_silent(house, shard_id)
    queue = Queue("redis://127.0.0.1:1/0")
    lame = Context(
        house.context.settings, house.context.sessions, house.context.store, queue, "lame", house.context.engine
    )
    try:
        reconcile(lame)
    finally:
        queue.close()
    assert _shard(house, shard_id).state == ShardState.QUEUED
