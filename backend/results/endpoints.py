"""/runs/{id}/figures, /frames and /files."""

from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.responses import StreamingResponse

from backend.platform import downloads
from backend.platform.dependencies import PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results import service
from backend.results.errors import FrameMissing, NotYet
from backend.results.schemas import Figure, FigureName, FrameDroplets, FrameFlow, ResultFiles, Which
from backend.results.service import Asker
from backend.runs.errors import NoSuchRun
from backend.stacks.errors import StackNotReady
from backend.stacks.pictures import read_frame

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])

FrameNumber = Annotated[int, Path(ge=0, le=2**31 - 1)]


def _asker(session: SessionDependency, viewer: ViewerDependency, run_id: UUID) -> Asker:
    return Asker(session, viewer, run_id)


AskerDependency = Annotated[Asker, Depends(_asker, scope="function")]


@router.get(
    "/figures/{name}",
    response_model=Figure,
    responses=responses(NoSuchRun, NotYet, StackNotReady, FrameMissing, InvalidRequest),
)
def figures_get(
    request: Request,
    platform: PlatformDependency,
    asker: AskerDependency,
    name: FigureName,
    frame: Annotated[int | None, Query(ge=0, le=2**31 - 1, description="For `flow_field`: which frame.")] = None,
) -> Response:
    """Get a figure of what is done so far, as Plotly draws it."""
    if name is FigureName.FLOW_FIELD and frame is not None:
        experiment = asker.run().experiment
        asker.product("track", frame)
        image = read_frame(
            request.app.state.open_stacks, platform.store, asker.session, asker.viewer, experiment, frame
        )
        return Response(service.flow_figure(asker, platform.store, image, frame), media_type="application/json")
    return Response(service.film_figure(asker, name), media_type="application/json")


@router.get("/frames/{frame}/droplets", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def droplets_get(
    platform: PlatformDependency, asker: AskerDependency, frame: FrameNumber, which: Which = Which.DETECTED
) -> FrameDroplets:
    """Get the droplets of one frame."""
    return service.droplets(asker, platform.store, frame, which)


@router.get("/frames/{frame}/flow", responses=responses(NoSuchRun, NotYet, InvalidRequest))
def flow_get(platform: PlatformDependency, asker: AskerDependency, frame: FrameNumber) -> FrameFlow:
    """Get the flow between a frame and the next."""
    return service.flow(asker, platform.store, frame)


@router.get("/files", responses=responses(NoSuchRun, InvalidRequest))
def result_files_list(asker: AskerDependency) -> ResultFiles:
    """List what there is to download so far."""
    return ResultFiles(items=service.files(asker))


@router.get(
    "/files/{name}",
    response_class=StreamingResponse,
    responses={**downloads.RESPONSES, **responses(NoSuchRun, NotYet, InvalidRequest)},
)
def result_files_download(
    request: Request, platform: PlatformDependency, asker: AskerDependency, name: str
) -> Response:
    """Download a table, the flow field or the summary, whole or by `Range`."""
    return downloads.answer(request, service.download(asker, platform.store, name))
