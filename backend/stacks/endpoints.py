"""/experiments/{id}/files, /stack and /frames."""

from http import HTTPStatus
from typing import Annotated, Literal
from uuid import UUID

from fastapi import APIRouter, Header, Path, Query, Request, Response
from fastapi.responses import StreamingResponse

from backend.experiments.errors import NoSuchExperiment
from backend.experiments.schemas import Experiment
from backend.experiments.service import shown
from backend.platform import downloads
from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.platform.store_errors import StoreAway, StoreFull
from backend.stacks import confirmation, service, upload
from backend.stacks.clock import Clock, clock
from backend.stacks.errors import OtherFacts, RunsExist, StackClosed, StackNotReady, TooLarge, WrongKind
from backend.stacks.images import PictureKind, as_picture
from backend.stacks.pictures import read_frame
from backend.stacks.schemas import Confirm, File, FileQuery, Files, Role

router = APIRouter(prefix="/experiments/{experiment_id}", tags=["frames"])

FrameNumber = Annotated[int, Path(ge=0, le=2**31 - 1)]
_RAW_BODY = {
    "requestBody": {
        "required": True,
        "description": "The bytes of the file.",
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


@router.get("/files", responses=responses(NoSuchExperiment, InvalidRequest))
def files_list(
    session: SessionDependency, viewer: ViewerDependency, experiment_id: UUID, query: Annotated[FileQuery, Query()]
) -> Files:
    """List the uploaded files, by role and name unless `sort` says otherwise."""
    return service.files(session, viewer, experiment_id, query)


@router.get(
    "/files/{file_id}",
    response_class=StreamingResponse,
    responses={**downloads.RESPONSES, **responses(NoSuchExperiment, InvalidRequest)},
)
def files_download(
    request: Request,
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ViewerDependency,
    experiment_id: UUID,
    file_id: UUID,
) -> Response:
    """Download an uploaded file as it came, whole or by `Range`."""
    return downloads.answer(request, service.download(session, platform.store, viewer, experiment_id, file_id))


@router.put(
    "/files",
    status_code=HTTPStatus.CREATED,
    responses=responses(NoSuchExperiment, StackClosed, TooLarge, WrongKind, InvalidRequest, StoreFull, StoreAway),
    openapi_extra=_RAW_BODY,
)
async def files_upload(
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    request: Request,
    name: Annotated[str, Query(description="Relative name, percent-encoded, such as `run 1/frame0001.tif`.")],
    role: Role = Role.FRAMES,
    content_length: Annotated[int | None, Header(ge=0, include_in_schema=False)] = None,
) -> File:
    """Upload one file as the raw body. The same name again replaces it. Then say `POST .../stack`."""
    said = upload.Upload(viewer, experiment_id, name, role, content_length)
    return File.model_validate(await upload.receive(platform, said, request.stream()))


@router.post(
    "/stack", status_code=HTTPStatus.ACCEPTED, responses=responses(NoSuchExperiment, StackClosed, InvalidRequest)
)
def stack_complete(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    missing: Annotated[
        Literal["refuse", "leave_out"], Query(description="What to do if announced files have not arrived.")
    ] = "refuse",
) -> Experiment:
    """Say that all files are there. Every frame is read; the stack becomes `ready` or `rejected` with the problem."""
    leave_out = missing == "leave_out"
    return shown(session, viewer, service.seal(session, platform, viewer, experiment_id, leave_out_missing=leave_out))


@router.put("/confirmation", responses=responses(NoSuchExperiment, StackNotReady, OtherFacts, InvalidRequest))
def stack_confirm(
    session: SessionDependency, viewer: EditorDependency, experiment_id: UUID, said: Confirm
) -> Experiment:
    """Say that order, times and scale of the frames are right; who said it, and when, is kept with them."""
    return shown(session, viewer, confirmation.confirm(session, viewer, experiment_id, said))


@router.delete("/stack", responses=responses(NoSuchExperiment, RunsExist, InvalidRequest))
def stack_delete(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> Experiment:
    """Remove all uploaded files, to upload others."""
    return shown(session, viewer, service.clear(session, viewer, experiment_id))


@router.get("/clock", responses=responses(NoSuchExperiment, StackNotReady, InvalidRequest))
def clock_get(
    session: SessionDependency, platform: PlatformDependency, viewer: ViewerDependency, experiment_id: UUID
) -> Clock:
    """Get the time of each frame, and its temperature where there is a log."""
    return clock(session, platform.store, viewer, experiment_id)


@router.get(
    "/frames/{frame}.{kind}",
    response_class=Response,
    responses={
        200: {"content": {kind.media_type: {} for kind in PictureKind}, "description": "The picture."},
        304: {"description": "The picture is the one you have."},
        **responses(NoSuchExperiment, StackClosed, InvalidRequest),
    },
)
def frames_picture(
    request: Request,
    platform: PlatformDependency,
    viewer: ViewerDependency,
    experiment_id: UUID,
    frame: FrameNumber,
    kind: PictureKind,
    max_side: Annotated[int, Query(ge=16, le=8192, description="Longest side in pixels.")] = 1200,
    v: Annotated[str | None, Query(max_length=64, description="`stack.checksum`: keeps the picture for ever.")] = None,
    if_none_match: Annotated[str | None, Header(include_in_schema=False)] = None,
) -> Response:
    """One frame as an 8-bit picture, its contrast stretched."""
    with platform.sessions.begin() as session:
        experiment = service.with_frame(session, viewer, experiment_id, frame)
        checksum = str(experiment.stack.checksum)
        tag = f'"{checksum[:16]}-{frame}-{max_side}-{kind}"'
        keep = "private, max-age=31536000, immutable" if v == checksum else "private, no-cache"
        headers = {"ETag": tag, "Cache-Control": keep}
        if if_none_match == tag:
            return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
        pixels = read_frame(request.app.state.open_stacks, platform.store, session, viewer, experiment, frame)
    return Response(as_picture(pixels, max_side, kind), media_type=kind.media_type, headers=headers)
