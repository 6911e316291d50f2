"""/runs/{id}/quality."""

from typing import Annotated

from fastapi import APIRouter, Query

from backend.platform.dependencies import PlatformDependency
from backend.platform.problems import InvalidRequest, responses
from backend.quality import service
from backend.quality.schemas import Quality
from backend.results.endpoints import AskerDependency
from backend.results.errors import NotYet
from backend.runs.errors import NoSuchRun

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])


@router.get("/quality", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def quality_get(
    platform: PlatformDependency,
    asker: AskerDependency,
    from_s: Annotated[float | None, Query(allow_inf_nan=False, description="Only frames from this time on.")] = None,
    to_s: Annotated[float | None, Query(allow_inf_nan=False, description="Only frames up to this time.")] = None,
    max_columns: Annotated[int, Query(ge=1, le=5000, description="Neighbouring frames are summed up.")] = 600,
) -> Quality:
    """Get how well a run did over time."""
    return service.over(asker, platform.store, from_s, to_s, max_columns)
