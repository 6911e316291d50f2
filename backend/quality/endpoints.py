"""/runs/{id}/quality."""

from typing import Annotated

from fastapi import APIRouter, Query

from backend.platform.dependencies import PlatformDependency
from backend.platform.problems import InvalidRequest, responses
from backend.quality import service
from backend.quality.schemas import Quality, QualityQuery
from backend.results.endpoints import AskerDependency
from backend.results.errors import NotYet
from backend.runs.errors import NoSuchRun

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])


@router.get("/quality", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def quality_get(
    platform: PlatformDependency, asker: AskerDependency, query: Annotated[QualityQuery, Query()]
) -> Quality:
    """Get how well a run did over time, of a part of the film or of all of it."""
    return service.over(asker, platform.store, query)
