"""Messages that cannot be sent keep nobody waiting."""

import time

import pytest
import redis

from backend.platform.queue import QUEUES, Queue


def test_without_a_broker_a_thousand_messages_are_given_up_at_once() -> None:
    queue = Queue("redis://127.0.0.1:1/0")
    began_s = time.monotonic()
    for _ in range(1000):
        queue.wake("detect")
    queue.close()
    assert time.monotonic() - began_s < 2.0


@pytest.mark.parametrize(
    ("task", "its_queue"),
    [("ingest", "ingest"), ("prepare", "shards"), ("detect", "shards"), ("track", "sequential"), ("analyse", "shards")],
)
def test_a_message_waits_in_the_queue_of_its_task(redis_url: str, task: str, its_queue: str) -> None:
    queue = Queue(redis_url)
    queue.wake(task)
    assert {name: queue.n_waiting(name) for name in QUEUES} == {name: int(name == its_queue) for name in QUEUES}
    queue.close()
    with redis.Redis.from_url(redis_url) as broker:
        broker.flushdb()
