"""`python -m worker.alive QUEUE`: whether the worker of a queue on this machine answers, for health checks.

It is asked as others ask it, through the broker: a worker that hears nothing any more takes no work either. While the
broker itself is away every worker counts as well, for to start one again would help nobody.
"""

import os
import sys

from celery import Celery
from celery.exceptions import OperationalError as CeleryError
from celery.utils.nodenames import gethostname, nodename
from kombu.exceptions import OperationalError
from redis.exceptions import RedisError

_ANSWER_S = 8.0
_PATIENCE = {"socket_connect_timeout": 2, "socket_timeout": 5}


def is_alive(redis_url: str, queue: str, *, patience_s: float = _ANSWER_S) -> bool:
    """Whether the worker named after `queue` and this machine answers in time, or nobody could ask it."""
    worker = nodename(queue, gethostname())
    # Not `make_celery`: all workers of a machine are asked every minute, and half of the time would go with imports.
    with Celery(broker=redis_url, set_as_current=False) as celery:
        celery.conf.broker_transport_options = _PATIENCE
        try:
            return bool(celery.control.ping(destination=[worker], timeout=patience_s, limit=1))
        except (CeleryError, OperationalError, RedisError, OSError):
            return True


def main() -> None:
    """Exit code 0: alive; 1: silent."""
    sys.exit(0 if is_alive(os.environ["REDIS_URL"], sys.argv[1]) else 1)


if __name__ == "__main__":
    main()
