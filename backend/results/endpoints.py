"""/runs/{id}/figures, /frames and /files."""

from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from fastapi.responses import StreamingResponse

from backend.platform import downloads
from backend.platform.dependencies import PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results import service
from backend.results.errors import ExportsBusy, NoTable, NotKept, NotOfThisFilm, NotYet
from backend.results.exporting import file_name
from backend.results.schemas import (
    Exports,
    Figure,
    FigureEntries,
    FigureName,
    FigureQuery,
    FrameDroplets,
    FrameFlow,
    ResultFiles,
    Which,
)
from backend.results.service import Asker
from backend.runs.errors import NoSuchRun
from backend.stacks.errors import StackNotReady
from backend.stacks.pictures import read_frame
from dropflow.exports.kinds import MEDIA_TYPE, Kind

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])

FrameNumber = Annotated[int, Path(ge=0, le=2**31 - 1)]


def _asker(session: SessionDependency, viewer: ViewerDependency, run_id: UUID) -> Asker:
    return Asker(session, viewer, run_id)


AskerDependency = Annotated[Asker, Depends(_asker, scope="function")]


@router.get("/figures", responses=responses(NoSuchRun, InvalidRequest))
def figures_list(asker: AskerDependency) -> FigureEntries:
    """List the figures: what each shows, what it can be asked, and whether it is there by now."""
    return FigureEntries(items=service.catalogue(asker))


@router.get(
    "/figures/{name}",
    response_model=Figure,
    responses=responses(NoSuchRun, NotYet, NotKept, NotOfThisFilm, StackNotReady, InvalidRequest),
)
def figures_get(
    request: Request,
    platform: PlatformDependency,
    asker: AskerDependency,
    name: FigureName,
    query: Annotated[FigureQuery, Query()],
) -> Response:
    """Get a figure as Plotly draws it, of what is done so far."""
    frame = service.looks_at(asker, name, query)
    if frame is None:
        drawn = service.figure(asker, platform.store, request.app.state.kept, name, query)
        return Response(drawn, media_type="application/json")
    experiment = asker.run.experiment
    image = None
    if frame < (experiment.stack.n_frames or 0):
        image = read_frame(
            request.app.state.open_stacks, platform.store, asker.session, asker.viewer, experiment, frame
        )
    drawn = service.frame_figure(asker, platform.store, name, query, image)
    return Response(drawn, media_type="application/json")


@router.get(
    "/figures/{name}/table.csv",
    response_class=StreamingResponse,
    responses={
        200: {"content": {"text/csv": {}}, "description": "The table; its first line is a comment."},
        **responses(NoSuchRun, NotYet, NotOfThisFilm, NoTable, InvalidRequest),
    },
)
def figures_table(
    platform: PlatformDependency, asker: AskerDependency, name: FigureName, query: Annotated[FigureQuery, Query()]
) -> StreamingResponse:
    """Download the numbers of a figure, of what is done so far."""
    content = service.table(asker, platform.store, name, query)
    headers = {"Content-Disposition": downloads.content_disposition(f"{name}.csv"), "X-Content-Type-Options": "nosniff"}
    return StreamingResponse(content, media_type="text/csv", headers=headers)


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


@router.get(
    "/report.html",
    response_class=StreamingResponse,
    responses={
        200: {"content": {"text/html": {}}, "description": "The page."},
        **responses(NoSuchRun, NotYet, InvalidRequest),
    },
)
def report_get(platform: PlatformDependency, asker: AskerDependency) -> StreamingResponse:
    """Get the report: one page with all figures, numbers, parameters, warnings and a methods paragraph."""
    # The page draws with scripts of its own; it may ask nobody, and nobody's page may hold it.
    policy = (
        "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; "
        "img-src data: blob:; sandbox allow-scripts allow-downloads"
    )
    headers = {"Content-Security-Policy": policy, "X-Content-Type-Options": "nosniff", "Cache-Control": "private"}
    return StreamingResponse(
        service.report(asker, platform.store), media_type="text/html; charset=utf-8", headers=headers
    )


@router.get("/exports", responses=responses(NoSuchRun, InvalidRequest))
def exports_list(asker: AskerDependency) -> Exports:
    """List the forms in which results can be had."""
    return Exports(items=service.exports(asker))


@router.get(
    "/exports/{kind}",
    response_class=Response,
    responses={
        200: {"content": {"*/*": {}}, "description": "The export."},
        **downloads.RESPONSES,
        **responses(NoSuchRun, NotYet, ExportsBusy, InvalidRequest),
    },
)
def exports_get(request: Request, platform: PlatformDependency, asker: AskerDependency, kind: Kind) -> Response:
    """Download results in another form; it is made while it is sent, and a download broken off begins anew."""
    if kind is Kind.ZARR:
        return downloads.answer(request, service.download(asker, platform.store, "flow.zarr.zip"))
    content = service.export(asker, platform.store, kind, platform.settings.work_dir)
    headers = {
        "Content-Disposition": downloads.content_disposition(file_name(kind, asker.run.number)),
        "X-Content-Type-Options": "nosniff",
    }
    return StreamingResponse(content, media_type=MEDIA_TYPE[kind], headers=headers)


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
