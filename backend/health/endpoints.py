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
from dropflow.provenance import code_version

router = APIRouter(tags=["health"])
log = structlog.get_logger()


class Health(BaseModel):
    """The service can do its work."""

    status: Literal["ok"] = "ok"
    version: str


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
        log.error("database away", reason=str(problem).splitlines()[0])
        raise Away("database") from None
    return Health(version=code_version())
