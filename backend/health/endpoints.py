"""/health."""

from http import HTTPStatus
from typing import Literal

import structlog
from fastapi import APIRouter
from pydantic import BaseModel
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from backend.platform.dependencies import PlatformDependency
from backend.platform.problems import ServiceError, responses
from backend.platform.reasons import reason_of
from dropflow.provenance import code_version

router = APIRouter(tags=["health"])
log = structlog.get_logger()


API_VERSION = "1.2"
"""Of /api/v1: a minor version only adds. `docs/reference/rest-api.md` says what each added."""


class Health(BaseModel):
    """The service can do its work."""

    status: Literal["ok"] = "ok"
    version: str
    """Of the software."""
    api_version: str = API_VERSION
    """Of the API: what worked with a smaller minor version works with this one."""


class Away(ServiceError):
    """A part that nothing works without is away."""

    status = HTTPStatus.SERVICE_UNAVAILABLE

    def __init__(self, part: str) -> None:
        super().__init__(f"The {part} cannot be reached.", code=f"service.{part}_away")


@router.get("/health", responses=responses(Away))
def health_get(platform: PlatformDependency) -> Health:
    """Tell whether the service can do its work."""
    try:
        with platform.sessions() as session:
            session.execute(text("SELECT 1"))
    except SQLAlchemyError as problem:
        log.error("database away", reason=reason_of(problem))
        raise Away("database") from None
    return Health(version=code_version())
