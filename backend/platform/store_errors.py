"""What can be wrong about the object store itself."""

import errno
from http import HTTPStatus

import structlog
from obstore.exceptions import BaseError

from backend.platform.problems import ServiceError
from backend.platform.reasons import reason_of

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_SAYS_FULL = ("No space left", "StorageFull", "InsufficientStorage", "QuotaExceeded", "Disk quota exceeded")
log = structlog.get_logger()


class StoreFull(ServiceError):
    """No room for more bytes."""

    default_code = "upload.no_space"
    status = HTTPStatus.INSUFFICIENT_STORAGE

    def __init__(self, detail: str = "The storage is full.") -> None:
        super().__init__(detail, hint="What arrived is kept. Make room there, then go on.")


class StoreAway(ServiceError):
    """It does not answer, or not sensibly."""

    default_code = "service.store_away"
    status = HTTPStatus.SERVICE_UNAVAILABLE

    def __init__(self) -> None:
        super().__init__("The storage cannot be reached just now.", hint="What arrived is kept. Try again.")


def store_error(problem: OSError | BaseError) -> ServiceError:
    """What a failure of the store means for whoever sends."""
    log.error("not stored", reason=reason_of(problem))
    is_full = getattr(problem, "errno", None) in _FULL or any(said in str(problem) for said in _SAYS_FULL)
    return StoreFull() if is_full else StoreAway()
