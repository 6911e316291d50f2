"""/runs/{id}/trajectories and the tails of a frame."""

from typing import Annotated

from fastapi import APIRouter, Path, Query

from backend.platform.dependencies import PlatformDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results.endpoints import AskerDependency, FrameNumber
from backend.results.errors import NotYet
from backend.runs.errors import NoSuchRun
from backend.trajectories import service
from backend.trajectories.errors import NoSuchTrajectory
from backend.trajectories.schemas import Tails, Trajectory

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])


@router.get("/frames/{frame}/tails", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def tails_get(
    platform: PlatformDependency,
    asker: AskerDependency,
    frame: FrameNumber,
    n_frames: Annotated[int, Query(ge=1, le=100, description="Frames to look back.")] = 10,
) -> Tails:
    """Get where the droplets of a frame were in the frames before."""
    return service.tails(asker, platform.store, frame, n_frames)


@router.get("/trajectories/{trajectory_id}", responses=responses(NoSuchRun, NoSuchTrajectory, NotYet, InvalidRequest))
def trajectories_get(
    platform: PlatformDependency,
    asker: AskerDependency,
    trajectory_id: Annotated[int, Path(ge=-(2**63), le=2**63 - 1)],
) -> Trajectory:
    """Get size, place and velocity of one droplet over time."""
    return service.trajectory(asker, platform.store, trajectory_id)
