"""Messages to workers: each says only "there is work in your queue". A lost one is sent again, a double one is idle."""

import time

import redis
import structlog
from celery import Celery
from kombu.exceptions import OperationalError
from redis.backoff import NoBackoff
from redis.exceptions import RedisError
from redis.retry import Retry

from backend.platform.previews import LONGEST_WAIT_S, PREVIEW_TASK, PreviewRequest

TASK_NAME = "worker.look_for_work"
QUEUE_OF_TASK = {
    "import": "ingest",
    "ingest": "ingest",
    "prepare": "shards",
    "detect": "shards",
    "track": "sequential",
    "analyse": "shards",
}
"""What takes seconds does not stand behind what takes hours: reading all frames, or tracking on one core."""

INTERACTIVE = "interactive"
"""The queue of what somebody looks at the page for; nothing longer than that ever waits in it."""

LONGEST_S = {"shards": 1800, INTERACTIVE: 300}
"""A process that is still at it after so long hangs; it is ended, and the work tried again. Others take as they do."""

AWAY_S = 2.0
"""So long after a failure nothing is sent: there may be thousands of messages, each of which would have to fail."""

QUEUES = (*dict.fromkeys(QUEUE_OF_TASK.values()), INTERACTIVE)
log = structlog.get_logger()


def make_celery(redis_url: str) -> Celery:
    """Celery as a carrier of messages and nothing else: no results, no chords, no acknowledgement to wait for."""
    app = Celery("dropflow", broker=redis_url)
    app.conf.update(
        task_ignore_result=True,
        task_acks_late=False,
        worker_prefetch_multiplier=1,
        task_default_queue="shards",
        task_create_missing_queues=True,
        task_serializer="json",
        accept_content=["json"],
        broker_connection_retry_on_startup=True,
        broker_transport_options={
            "visibility_timeout": 3600,
            "unacked_restore_interval": 10,
            "socket_connect_timeout": 2,
            "socket_timeout": 5,
        },
        worker_hijack_root_logger=False,
        worker_soft_shutdown_timeout=2.0,
        worker_enable_soft_shutdown_on_idle=False,
    )
    return app


class Queue:
    """Sends messages. That it could not is no error: the reconciler finds what nobody looks at."""

    def __init__(self, redis_url: str) -> None:
        self._celery = make_celery(redis_url)
        self._broker = redis.Redis.from_url(
            redis_url, socket_connect_timeout=2, socket_timeout=5, retry=Retry(NoBackoff(), 0)
        )
        self._is_away_until_s = 0.0

    def wake(self, task: str) -> None:
        """Ask for a worker to look for work of this kind. Whose turn it is, the worker finds in the database."""
        if time.monotonic() < self._is_away_until_s:
            return
        queue = QUEUE_OF_TASK[task]
        longest_s = LONGEST_S.get(queue)
        limits = {} if longest_s is None else {"soft_time_limit": longest_s, "time_limit": longest_s + 60}
        try:
            self._broker.ping()  # Celery would try to connect for seconds, and somebody may be waiting for an answer
            self._celery.send_task(TASK_NAME, [queue], queue=queue, retry=False, **limits)
        except (OperationalError, RedisError, OSError) as problem:
            self._is_away_until_s = time.monotonic() + AWAY_S
            log.warning("message not sent", queue=queue, reason=str(problem))

    def preview(self, request: PreviewRequest) -> None:
        """Ask for a look that somebody waits for. If the message is lost, they ask again."""
        try:
            self._broker.ping()
            limit_s = LONGEST_WAIT_S
            self._celery.send_task(
                PREVIEW_TASK,
                [request.model_dump_json()],
                queue=INTERACTIVE,
                retry=False,
                expires=limit_s,
                soft_time_limit=limit_s,
                time_limit=limit_s + 30,
            )
        except (OperationalError, RedisError, OSError) as problem:
            log.warning("preview not asked for", reason=str(problem))

    def n_waiting(self, queue: str) -> int:
        """Messages that no worker has taken yet."""
        return int(self._broker.llen(queue))

    def close(self) -> None:
        """Let go of the broker."""
        self._celery.close()
        self._broker.close()
