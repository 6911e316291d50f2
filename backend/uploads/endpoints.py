"""/experiments/{id}/uploads: resumable uploads by tus 1.0, and the plan that makes them easy to use."""

from datetime import UTC
from email.utils import format_datetime
from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, HTTPException, Request, Response
from fastapi.concurrency import run_in_threadpool

from backend.experiments.errors import NoSuchExperiment
from backend.platform.dependencies import (
    EditorDependency,
    Platform,
    PlatformDependency,
    SessionDependency,
    ViewerDependency,
)
from backend.platform.problems import InvalidRequest, responses
from backend.platform.store_errors import StoreAway, StoreFull
from backend.platform.visibility import Viewer
from backend.stacks.errors import StackClosed, TooLarge, WrongKind
from backend.uploads import headers as tus
from backend.uploads import service
from backend.uploads.creation import announced
from backend.uploads.errors import (
    BadHeader,
    ChecksumMismatch,
    InUse,
    NoSuchUpload,
    TooManyBytes,
    WrongContentType,
    WrongOffset,
    WrongVersion,
)
from backend.uploads.intake import Intakes
from backend.uploads.schemas import Announced, NewPlan, Plan, Upload, Uploads
from backend.uploads.sending import Progress, finish_if_complete, send

router = APIRouter(prefix="/experiments/{experiment_id}/uploads", tags=["uploads"])

_PROTOCOL = {"Tus-Resumable": tus.VERSION, "Cache-Control": "no-store"}
_BYTES = {
    "description": "The bytes from `Upload-Offset` on.",
    "content": {tus.BYTES_TYPE: {"schema": {"type": "string", "format": "binary"}}},
}
_SENDING = responses(
    NoSuchUpload, WrongOffset, InUse, ChecksumMismatch, TooManyBytes, WrongContentType, WrongVersion, BadHeader,
    StackClosed, WrongKind, StoreFull, StoreAway, InvalidRequest,
)  # fmt: skip


def _speaks_tus(request: Request) -> None:
    tus.check_version(request.headers)


def get_intakes(request: Request) -> Intakes:
    """What is known of uploads between two requests."""
    intakes: Intakes = request.app.state.intakes
    return intakes


IntakesDependency = Annotated[Intakes, Depends(get_intakes)]
_TUS = [Depends(_speaks_tus)]


@router.post("/plan", responses=responses(NoSuchExperiment, StackClosed, TooLarge, InvalidRequest, StoreFull))
def uploads_plan(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    new: NewPlan,
) -> Plan:
    """Say which files should be here: the answer is what is to be sent. Asked again, it says what is left to send."""
    return service.plan(session, platform, viewer, experiment_id, new.files)


@router.api_route("/plan", methods=["GET", "HEAD", "PATCH", "DELETE"], include_in_schema=False)
def uploads_plan_otherwise() -> None:
    """It is no upload of the id "plan", which could be asked, sent to or ended."""
    raise HTTPException(HTTPStatus.METHOD_NOT_ALLOWED)


@router.get("", responses=responses(NoSuchExperiment, InvalidRequest))
def uploads_list(session: SessionDependency, viewer: ViewerDependency, experiment_id: UUID) -> Uploads:
    """What was announced and has not arrived."""
    return service.listed(session, viewer, experiment_id)


@router.options("", status_code=HTTPStatus.NO_CONTENT, include_in_schema=False)
def uploads_options(platform: PlatformDependency) -> Response:
    """What of tus this server can."""
    return Response(
        status_code=HTTPStatus.NO_CONTENT,
        headers={
            "Tus-Resumable": tus.VERSION,
            "Tus-Version": tus.VERSION,
            "Tus-Extension": tus.EXTENSIONS,
            "Tus-Max-Size": str(platform.settings.max_file_bytes),
            "Tus-Checksum-Algorithm": ",".join(tus.ALGORITHMS),
        },
    )


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    response_class=Response,
    dependencies=_TUS,
    responses={**_SENDING, **responses(NoSuchExperiment, TooLarge)},
    openapi_extra={"requestBody": {**_BYTES, "required": False}},
)
async def uploads_create(
    request: Request,
    platform: PlatformDependency,
    viewer: EditorDependency,
    intakes: IntakesDependency,
    experiment_id: UUID,
) -> Response:
    """Begin an upload of one file, as tus clients do (`Upload-Length`, `Upload-Metadata`), perhaps with its bytes."""
    file = announced(request.headers)
    upload_id = await run_in_threadpool(_create, platform, viewer, experiment_id, file)
    answer = {**_PROTOCOL, "Location": f"uploads/{upload_id}"}
    if request.headers.get("content-type") == tus.BYTES_TYPE:
        answer |= _told(await send(platform, intakes, viewer, experiment_id, upload_id, 0, request))
    else:
        answer |= _told(await run_in_threadpool(finish_if_complete, platform, viewer, experiment_id, upload_id))
    return Response(status_code=HTTPStatus.CREATED, headers=answer)


def _create(platform: Platform, viewer: Viewer, experiment_id: UUID, file: Announced) -> UUID:
    with platform.sessions.begin() as session:
        return service.create(session, platform, viewer, experiment_id, file).id


@router.get("/{upload_id}", responses=responses(NoSuchUpload, InvalidRequest))
def uploads_get(session: SessionDependency, viewer: ViewerDependency, experiment_id: UUID, upload_id: UUID) -> Upload:
    """Look at one upload."""
    return service.look(session, viewer, experiment_id, upload_id)


@router.head(
    "/{upload_id}",
    response_class=Response,
    dependencies=_TUS,
    responses=responses(NoSuchUpload, WrongVersion, InvalidRequest),
)
def uploads_offset(
    platform: PlatformDependency, viewer: EditorDependency, experiment_id: UUID, upload_id: UUID
) -> Response:
    """Ask how much of an upload is here: `Upload-Offset` of `Upload-Length` bytes."""
    progress = finish_if_complete(platform, viewer, experiment_id, upload_id)
    return Response(headers={**_PROTOCOL, **_told(progress), "Upload-Length": str(progress.size_bytes)})


@router.patch(
    "/{upload_id}",
    status_code=HTTPStatus.NO_CONTENT,
    response_class=Response,
    dependencies=_TUS,
    responses=_SENDING,
    openapi_extra={"requestBody": {**_BYTES, "required": True}},
)
async def uploads_send(
    request: Request,
    platform: PlatformDependency,
    viewer: EditorDependency,
    intakes: IntakesDependency,
    experiment_id: UUID,
    upload_id: UUID,
) -> Response:
    """Send bytes from `Upload-Offset` on. What came before a cut connection stays."""
    tus.check_bytes_type(request.headers)
    offset_bytes = tus.number(request.headers, "Upload-Offset")
    progress = await send(platform, intakes, viewer, experiment_id, upload_id, offset_bytes, request)
    return Response(status_code=HTTPStatus.NO_CONTENT, headers={**_PROTOCOL, **_told(progress)})


@router.delete(
    "/{upload_id}",
    status_code=HTTPStatus.NO_CONTENT,
    response_class=Response,
    responses=responses(NoSuchUpload, InvalidRequest),
)
def uploads_terminate(
    session: SessionDependency, viewer: EditorDependency, experiment_id: UUID, upload_id: UUID
) -> Response:
    """Give up an upload: what of it arrived is removed. Files that are complete stay."""
    service.terminate(session, viewer, experiment_id, upload_id)
    return Response(status_code=HTTPStatus.NO_CONTENT, headers=_PROTOCOL)


def _told(progress: Progress) -> dict[str, str]:
    expires = format_datetime(progress.expires_at.astimezone(UTC), usegmt=True)
    return {"Upload-Offset": str(progress.offset_bytes), "Upload-Expires": expires}
