"""What can be done with the frames of an experiment."""

from uuid import UUID

from sqlalchemy.orm import Session

from backend.experiments.service import get, get_locked
from backend.models import Experiment, Shard, Stack
from backend.models.lifecycle import doom, remove_files
from backend.models.states import STACK_RULES, StackState, rule
from backend.platform.database import after_commit
from backend.platform.dependencies import Platform
from backend.platform.downloads import Download
from backend.platform.events import announce, experiment_topic
from backend.platform.object_store import ObjectStore
from backend.platform.places import Place
from backend.platform.store_files import place_of
from backend.platform.visibility import Viewer
from backend.stacks import repository, schemas
from backend.stacks.attachments import disagreements
from backend.stacks.errors import (
    FilesMissing,
    FramesExpired,
    NoSuchFile,
    NoSuchFrame,
    RunsExist,
    StackClosed,
    StackEmpty,
    StackNotReady,
)
from dropflow.errors import ExperimentError


def files(session: Session, viewer: Viewer, experiment_id: UUID, query: schemas.FileQuery) -> schemas.Files:
    """One page of the uploaded files."""
    get(session, viewer, experiment_id)
    found, next_cursor = repository.page(session, viewer, query, experiment_id)
    return schemas.Files(items=[schemas.File.model_validate(file) for file in found], next_cursor=next_cursor)


def download(session: Session, store: ObjectStore, viewer: Viewer, experiment_id: UUID, file_id: UUID) -> Download:
    """An uploaded file as it came, byte by byte."""
    get(session, viewer, experiment_id)
    file = repository.file(session, viewer, experiment_id, file_id)
    if file is None:
        raise NoSuchFile
    place = place_of(file)
    return Download(
        name=file.name,
        media_type="application/octet-stream",
        size_bytes=file.size_bytes,
        tag=f'"{file.sha256}"',
        sha256=file.sha256,
        read=lambda start, stop: store.stream_place(place, start, stop),
    )


def seal(
    session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, *, leave_out_missing: bool = False
) -> Experiment:
    """All files are there: have a worker read every frame."""
    experiment = get_locked(session, viewer, experiment_id)
    found = repository.files(session, viewer, experiment_id)
    if experiment.stack.state in (StackState.INDEXING, StackState.READY):
        raise StackClosed
    if not any(file.role == schemas.Role.FRAMES for file in found):
        raise StackEmpty
    _end_uploads(session, experiment_id, leave_out_missing=leave_out_missing)
    if problems := disagreements(experiment.document, [(file.role, file.name) for file in found]):
        raise ExperimentError("The experiment and the uploaded files do not agree.", fields=problems)
    experiment.stack.state = rule(STACK_RULES, "seal").target
    shard = Shard(experiment_id=experiment.id, person_id=viewer.person_id, task="ingest")
    session.add(shard)
    session.flush()
    announce(session, experiment_topic(experiment.id))
    after_commit(session, lambda: platform.queue.wake(shard.task))
    return experiment


def _end_uploads(session: Session, experiment_id: UUID, *, leave_out_missing: bool) -> None:
    coming = (repository.missing(session, experiment_id), repository.missing_of_import(session, experiment_id))
    n_missing, n_bytes = (sum(part) for part in zip(*coming, strict=True))
    if n_missing and not leave_out_missing:
        raise FilesMissing(n_missing, n_bytes)
    doom(session, repository.end_uploads(session, experiment_id))


def clear(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    """Remove the frames and everything that was uploaded beside them; an index that goes on is given up."""
    experiment = get_locked(session, viewer, experiment_id)
    if repository.has_runs(session, experiment_id):
        raise RunsExist
    keys = [key for key in (experiment.stack.index_key,) if key]
    doom(session, [*keys, *repository.end_uploads(session, experiment_id)])
    repository.delete_ingest(session, experiment_id)
    remove_files(session, experiment_id)
    _empty(experiment.stack)
    announce(session, experiment_topic(experiment.id))
    session.flush()
    return experiment


def _empty(stack: Stack) -> None:
    stack.state = rule(STACK_RULES, "clear").target
    stack.n_frames = stack.rows = stack.columns = stack.dtype = stack.duration_s = None
    stack.checksum = stack.index_key = stack.problem = None
    stack.warnings, stack.broken_frames = [], []
    stack.confirmed_at = stack.confirmation = None


def with_frame(session: Session, viewer: Viewer, experiment_id: UUID, frame: int) -> Experiment:
    """The experiment, if it has such a frame."""
    experiment = get(session, viewer, experiment_id)
    n_frames = experiment.stack.n_frames
    if experiment.stack.state == StackState.EXPIRED:
        raise FramesExpired
    if experiment.stack.state != StackState.READY or n_frames is None:
        raise StackNotReady
    if not 0 <= frame < n_frames:
        raise NoSuchFrame(frame)
    return experiment


def frame_files(session: Session, viewer: Viewer, experiment_id: UUID) -> dict[str, Place]:
    """Where each file of frames is kept, by name."""
    return repository.places(session, viewer, experiment_id, schemas.Role.FRAMES)
