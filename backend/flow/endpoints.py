"""/runs/{id}/flow_map."""

from typing import Annotated

from fastapi import APIRouter, Query

from backend.flow import service
from backend.flow.schemas import FlowMap
from backend.platform.dependencies import PlatformDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results.endpoints import AskerDependency
from backend.results.errors import NotYet
from backend.runs.errors import NoSuchRun

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])


@router.get("/flow_map", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def flow_maps_get(
    platform: PlatformDependency,
    asker: AskerDependency,
    frame: Annotated[int | None, Query(ge=0, le=2**31 - 1, description="One step: this frame to the next.")] = None,
    from_s: Annotated[float | None, Query(allow_inf_nan=False, description="Mean over a range of time.")] = None,
    to_s: Annotated[float | None, Query(allow_inf_nan=False)] = None,
) -> FlowMap:
    """Get the flow with its speed, vorticity and divergence, at one step or averaged over a range of time."""
    if frame is not None:
        return service.at_frame(asker, platform.store, frame)
    return service.over(asker, platform.store, from_s, to_s)
