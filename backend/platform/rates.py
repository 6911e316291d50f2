"""How often somebody may try: counted in Redis for all processes, in this one's memory while Redis is away."""

from http import HTTPStatus

import structlog
from limits import RateLimitItem, RateLimitItemPerMinute
from limits.errors import StorageError
from limits.storage import MemoryStorage, RedisStorage
from limits.strategies import SlidingWindowCounterRateLimiter

from backend.platform.problems import ServiceError

log = structlog.get_logger()


class TooOften(ServiceError):
    """Asked again too soon."""

    default_code = "request.too_often"
    status = HTTPStatus.TOO_MANY_REQUESTS

    def __init__(self, what: str, per_minute: int) -> None:
        super().__init__(
            f"Too many {what}: {per_minute} a minute are taken.",
            hint="Wait a minute, then try again.",
            headers={"Retry-After": "60"},
        )


class Rates:
    """Counts by what is done and by whom. An emptied Redis forgets, and nothing else happens."""

    def __init__(self, redis_url: str) -> None:
        storage = RedisStorage(redis_url, wrap_exceptions=True, socket_connect_timeout=1, socket_timeout=2)
        self._shared = SlidingWindowCounterRateLimiter(storage)
        self._own = SlidingWindowCounterRateLimiter(MemoryStorage())

    def count(self, what: str, who: str, per_minute: int) -> None:
        """Count one try, and refuse it if there were too many."""
        if not self._hit(RateLimitItemPerMinute(per_minute), what, who):
            raise TooOften(what, per_minute)

    def _hit(self, limit: RateLimitItem, what: str, who: str) -> bool:
        try:
            return self._shared.hit(limit, "dropflow", what, who)
        except StorageError as problem:
            log.warning("rates counted in memory", reason=str(problem.storage_error))
            return self._own.hit(limit, "dropflow", what, who)
