"""One request that brings bytes, from taking the upload to recording its files if it was the last one."""

from dataclasses import dataclass
from datetime import datetime
from uuid import UUID

from fastapi import Request
from fastapi.concurrency import run_in_threadpool

from backend.platform.dependencies import Platform
from backend.platform.visibility import Viewer
from backend.uploads import headers as tus
from backend.uploads import holding, service
from backend.uploads.errors import InUse, TooManyBytes
from backend.uploads.finishing import finish
from backend.uploads.intake import Intake, Intakes
from backend.uploads.reception import receive


@dataclass(frozen=True)
class Progress:
    """How far an upload is."""

    offset_bytes: int
    size_bytes: int
    expires_at: datetime


async def send(
    platform: Platform,
    intakes: Intakes,
    viewer: Viewer,
    experiment_id: UUID,
    upload_id: UUID,
    offset_bytes: int,
    request: Request,
) -> Progress:
    """Take in the body of a request. No transaction is open while its bytes come."""
    checksum = tus.checksum(request.headers)
    held = await run_in_threadpool(holding.take, platform, viewer, experiment_id, upload_id, offset_bytes)
    if held is not None:
        announced_bytes = request.headers.get("content-length", "")
        if announced_bytes.isdecimal() and offset_bytes + int(announced_bytes) > held.size_bytes:
            await run_in_threadpool(holding.let_go, platform, held, offset_bytes, ())
            raise TooManyBytes(held.size_bytes)
        intake = intakes.take(upload_id, held.files, offset_bytes)
        reached_bytes = await receive(platform, held, intake, checksum, request.receive)
        if reached_bytes == held.size_bytes:
            await run_in_threadpool(finish, platform, held, intake)
        elif intake.at_byte == reached_bytes:
            intakes.keep(upload_id, intake)
    return await run_in_threadpool(progress, platform, viewer, experiment_id, upload_id)


def progress(platform: Platform, viewer: Viewer, experiment_id: UUID, upload_id: UUID) -> Progress:
    """How far it is."""
    with platform.sessions.begin() as session:
        upload = service.find(session, viewer, experiment_id, upload_id)
        if upload.problem is not None:
            raise holding.refused(upload)
        return Progress(upload.offset_bytes, upload.size_bytes, upload.expires_at)


def finish_if_complete(platform: Platform, viewer: Viewer, experiment_id: UUID, upload_id: UUID) -> Progress:
    """How far it is; and if the service stopped between its last byte and recording its files, that is done now."""
    found = progress(platform, viewer, experiment_id, upload_id)
    if found.offset_bytes < found.size_bytes:
        return found
    try:
        held = holding.take(platform, viewer, experiment_id, upload_id, found.size_bytes)
    except InUse:
        return found  # somebody is at it
    if held is not None:
        finish(platform, held, Intake(held.files, found.size_bytes))
    return found
