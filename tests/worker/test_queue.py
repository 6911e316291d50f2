"""Messages that cannot be sent keep nobody waiting."""

import time
from uuid import uuid4

import pytest
import redis

from backend.platform.queue import QUEUES, Queue


def test_without_a_broker_a_thousand_messages_are_given_up_at_once() -> None:
    queue = Queue("redis://127.0.0.1:1/0")
    began_s = time.monotonic()
    for _ in range(1000):
        queue.send(uuid4(), "detect")
    queue.close()
    assert time.monotonic() - began_s < 2.0


@pytest.mark.parametrize(
    ("task", "its_queue"), [("ingest", "interactive"), ("detect", "shards"), ("track", "sequential")]
)
def test_a_message_waits_in_the_queue_of_its_task(redis_url: str, task: str, its_queue: str) -> None:
    queue = Queue(redis_url)
    queue.send(uuid4(), task)
    assert {name: queue.n_waiting(name) for name in QUEUES} == {name: int(name == its_queue) for name in QUEUES}
    queue.close()
    with redis.Redis.from_url(redis_url) as broker:
        broker.flushdb()
