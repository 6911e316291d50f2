"""/administration."""

from typing import Annotated

from fastapi import APIRouter, Query

from backend.administration import service
from backend.administration.schemas import AuditLog, AuditQuery, Overview
from backend.platform.dependencies import AdministratorDependency, PlatformDependency, SessionDependency
from backend.platform.problems import InvalidRequest, responses

router = APIRouter(prefix="/administration", tags=["administration"])


@router.get("")
def administration_get(
    session: SessionDependency, platform: PlatformDependency, _: AdministratorDependency
) -> Overview:
    """Look at queues, workers, disk, and work that failed or goes on for long. For administrators."""
    return service.overview(session, platform.store)


@router.get("/audit", responses=responses(InvalidRequest))
def audit_list(
    session: SessionDependency, _: AdministratorDependency, query: Annotated[AuditQuery, Query()]
) -> AuditLog:
    """Read who did what, newest first. For administrators."""
    return service.audit(session, query)
