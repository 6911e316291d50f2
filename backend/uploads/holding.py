"""Holding an upload: who may write to it, and until when others keep away. Each step is one short transaction."""

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from sqlalchemy import func

from backend.models import Upload
from backend.models.lifecycle import doom
from backend.platform.dependencies import Platform
from backend.platform.places import Piece
from backend.platform.problems import Problem, ServiceError
from backend.platform.visibility import Viewer
from backend.uploads import repository, service
from backend.uploads.errors import InUse, NoSuchUpload, WrongOffset
from backend.uploads.schemas import Announced

HOLD_S = 10.0
"""A sender that is silent for so long may be gone: then another one may go on."""


@dataclass(frozen=True)
class Held:
    """An upload in our hands."""

    viewer: Viewer
    experiment_id: UUID
    upload_id: UUID
    fence: int
    store_key: str
    files: Sequence[Announced]
    size_bytes: int
    offset_bytes: int
    """When we took it."""


def refused(upload: Upload) -> ServiceError:
    """Why an upload was refused: the same answer again."""
    problem = Problem.model_validate(upload.problem)
    return ServiceError(problem.detail, code=problem.code, status=problem.status, file=problem.file, hint=problem.hint)


def take(platform: Platform, viewer: Viewer, experiment_id: UUID, upload_id: UUID, offset_bytes: int) -> Held | None:
    """Take an upload to send it from this byte on; None if all of it is here and recorded."""
    with platform.sessions.begin() as session:
        upload = service.find(session, viewer, experiment_id, upload_id, lock=True)
        if upload.problem is not None:
            raise refused(upload)
        if upload.offset_bytes != offset_bytes:
            raise WrongOffset(upload.offset_bytes)
        if upload.finished_at is not None:
            return None
        service.open_experiment(session, viewer, experiment_id)
        if upload.held_until is not None and upload.held_until > session.scalar(func.clock_timestamp()):
            raise InUse
        upload.fence += 1
        upload.held_until = repository.in_seconds(HOLD_S)
        return Held(
            viewer,
            experiment_id,
            upload_id,
            upload.fence,
            upload.store_key,
            service.announced_files(upload),
            upload.size_bytes,
            offset_bytes,
        )


def save(platform: Platform, held: Held, offset_bytes: int, pieces: Sequence[Piece], *, is_alive: bool) -> None:
    """Write down what is safe by now, and keep the upload while bytes come."""
    values = {"expires_at": repository.in_seconds(platform.settings.upload_expires_s)}
    if is_alive:
        values["held_until"] = repository.in_seconds(HOLD_S)
    with platform.sessions.begin() as session:
        if not repository.advance(
            session, held.upload_id, held.fence, offset_bytes=offset_bytes, pieces=pieces, values=values
        ):
            raise _lost(platform, held)


def let_go(platform: Platform, held: Held, offset_bytes: int, pieces: Sequence[Piece]) -> None:
    """Write down what is safe, and let others have the upload at once."""
    with platform.sessions.begin() as session:
        repository.advance(
            session, held.upload_id, held.fence, offset_bytes=offset_bytes, pieces=pieces, values={"held_until": None}
        )


def refuse(platform: Platform, held: Held, problem: Problem) -> None:
    """It can never be taken: say so to whoever asks again, and remove what came."""
    with platform.sessions.begin() as session:
        values = {"problem": problem.model_dump(), "held_until": None}
        if repository.advance(session, held.upload_id, held.fence, offset_bytes=0, pieces=(), values=values):
            repository.forget_pieces(session, held.upload_id)
            doom(session, [held.store_key])


def begin_anew(platform: Platform, held: Held) -> None:
    """None of its bytes count."""
    with platform.sessions.begin() as session:
        if repository.advance(
            session, held.upload_id, held.fence, offset_bytes=0, pieces=(), values={"held_until": None}
        ):
            repository.forget_pieces(session, held.upload_id)


def _lost(platform: Platform, held: Held) -> ServiceError:
    with platform.sessions.begin() as session:
        upload = repository.find(session, held.viewer, held.experiment_id, held.upload_id)
        return NoSuchUpload() if upload is None else InUse()
