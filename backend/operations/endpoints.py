"""/healthz and /readyz: what machines ask, outside the API."""

from fastapi import APIRouter, Response, status
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from backend.platform.dependencies import PlatformDependency

router = APIRouter(include_in_schema=False)


@router.get("/healthz")
async def process_is_alive() -> dict[str, str]:
    """Tell that this process answers, whatever else is away: to start it again would help nobody."""
    return {"status": "ok"}


@router.get("/readyz")
def service_is_ready(platform: PlatformDependency, response: Response) -> dict[str, str]:
    """Tell whether requests can be served: 503 while the database or the object store is away."""
    found = {"database": "ok", "object_store": "ok"}
    try:
        with platform.sessions() as session:
            session.execute(text("SELECT 1"))
    except SQLAlchemyError:
        found["database"] = "away"
    try:
        platform.store.answers()
    except Exception:
        found["object_store"] = "away"
    if "away" in found.values():
        response.status_code = status.HTTP_503_SERVICE_UNAVAILABLE
    return found
