"""What can be done with uploads: plan them, look at them, take them back."""

from collections.abc import Sequence
from uuid import UUID, uuid4

from sqlalchemy.orm import Session

from backend.experiments.service import get, get_locked
from backend.models import Experiment, Upload
from backend.models.lifecycle import doom
from backend.models.states import STACK_RULES, rule
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic
from backend.platform.object_store import upload_key
from backend.platform.problems import InvalidRequest, Problem
from backend.platform.visibility import Viewer
from backend.stacks.errors import StackClosed
from backend.stacks.repository import missing
from backend.uploads import repository, schemas
from backend.uploads.errors import NoSuchUpload
from backend.uploads.planning import Decision, Open, decide
from backend.uploads.room import check_files, check_room
from backend.uploads.schemas import Announced, UploadState
from dropflow.errors import FieldProblem

_MOST_SHOWN = 100


def plan(
    session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, wanted: Sequence[Announced]
) -> schemas.Plan:
    """Say what of these files is to be sent, and in which uploads. The same question again has the same answer."""
    check_files(platform, wanted)
    _check_distinct(wanted)
    experiment = open_experiment(session, viewer, experiment_id, lock=True)
    begun = repository.unfinished(session, experiment_id)
    there = repository.there(session, experiment_id, [file.key for file in wanted])
    decision = decide(wanted, there, _as_open(begun, repository.held_ids(session, experiment_id)))
    _end(session, [upload for upload in begun if upload.id in decision.end])
    new = [wanted[index] for bundle in decision.begin for index in bundle]
    check_room(session, platform, experiment, new, there)
    for files in decision.keep_announced:
        _begin(session, platform, experiment, files)
    planned = [
        *_continued(begun, decision),
        *(
            _planned(_begin(session, platform, experiment, [wanted[i] for i in bundle]), bundle)
            for bundle in decision.begin
        ),
    ]
    present = [schemas.Present(file=index, sha256=sha256) for index, sha256 in decision.present.items()]
    return schemas.Plan(uploads=planned, present=present)


def create(session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, file: Announced) -> Upload:
    """Begin an upload of one file, as plain tus clients do."""
    check_files(platform, [file])
    experiment = open_experiment(session, viewer, experiment_id, lock=True)
    check_room(session, platform, experiment, [file], repository.there(session, experiment_id, [file.key]))
    return _begin(session, platform, experiment, [file])


def listed(session: Session, viewer: Viewer, experiment_id: UUID) -> schemas.Uploads:
    """What was announced and has not arrived."""
    get(session, viewer, experiment_id)
    n_files, n_bytes = missing(session, experiment_id)
    found = repository.first_unfinished(session, experiment_id, _MOST_SHOWN)
    items = [_shown(upload, name) for upload, name in found]
    return schemas.Uploads(n_files_missing=n_files, n_bytes_missing=n_bytes, items=items)


def look(session: Session, viewer: Viewer, experiment_id: UUID, upload_id: UUID) -> schemas.Upload:
    """One upload as the API shows it."""
    upload = find(session, viewer, experiment_id, upload_id)
    return _shown(upload, str(upload.files[0]["name"]))


def find(session: Session, viewer: Viewer, experiment_id: UUID, upload_id: UUID, *, lock: bool = False) -> Upload:
    """One upload."""
    get(session, viewer, experiment_id)
    upload = repository.find(session, viewer, experiment_id, upload_id, lock=lock)
    if upload is None:
        raise NoSuchUpload
    return upload


def terminate(session: Session, viewer: Viewer, experiment_id: UUID, upload_id: UUID) -> None:
    """Forget an upload and what of it arrived. Files that are complete stay."""
    upload = find(session, viewer, experiment_id, upload_id, lock=True)
    if upload.finished_at is not None:
        session.delete(upload)
    else:
        _end(session, [upload])
    announce(session, experiment_topic(experiment_id))


def announced_files(upload: Upload) -> list[Announced]:
    """The files of an upload."""
    return [Announced.model_validate(file) for file in upload.files]


def open_experiment(session: Session, viewer: Viewer, experiment_id: UUID, *, lock: bool = False) -> Experiment:
    """The experiment, if it still takes files."""
    experiment = (get_locked if lock else get)(session, viewer, experiment_id)
    if experiment.stack.state not in rule(STACK_RULES, "upload").sources:
        raise StackClosed
    return experiment


def _begin(session: Session, platform: Platform, experiment: Experiment, files: Sequence[Announced]) -> Upload:
    upload_id = uuid4()
    upload = Upload(
        id=upload_id,
        experiment_id=experiment.id,
        files=[file.model_dump(mode="json") for file in files],
        n_files=len(files),
        size_bytes=sum(file.size_bytes for file in files),
        store_key=upload_key(experiment.id, upload_id, can_grow=platform.store.can_grow),
        offset_bytes=0,
        expires_at=repository.in_seconds(platform.settings.upload_expires_s),
    )
    session.add(upload)
    experiment.stack.state = rule(STACK_RULES, "upload").target
    experiment.stack.problem = None
    session.flush()
    return upload


def _end(session: Session, uploads: Sequence[Upload]) -> None:
    doom(session, [upload.store_key for upload in uploads])
    for upload in uploads:
        session.delete(upload)
    session.flush()


def _as_open(begun: Sequence[Upload], held: set[UUID]) -> list[Open]:
    return [
        Open(
            upload.id,
            announced_files(upload),
            is_held=upload.id in held,
            is_refused=upload.problem is not None,
        )
        for upload in begun
    ]


def _continued(begun: Sequence[Upload], decision: Decision) -> list[schemas.PlannedUpload]:
    return [_planned(upload, decision.go_on[upload.id]) for upload in begun if upload.id in decision.go_on]


def _planned(upload: Upload, files: list[int]) -> schemas.PlannedUpload:
    return schemas.PlannedUpload(
        id=upload.id,
        location=f"experiments/{upload.experiment_id}/uploads/{upload.id}",
        size_bytes=upload.size_bytes,
        offset_bytes=upload.offset_bytes,
        files=files,
    )


def _check_distinct(wanted: Sequence[Announced]) -> None:
    first: dict[tuple[str, str], int] = {}
    for index, file in enumerate(wanted):
        if first.setdefault(file.key, index) != index:
            problem = FieldProblem(f"files.{index}.name", f"is there twice: {file.name}")
            raise InvalidRequest("The request is not as expected.", fields=[problem])


def _shown(upload: Upload, first_name: str) -> schemas.Upload:
    return schemas.Upload(
        id=upload.id,
        state=_state(upload),
        size_bytes=upload.size_bytes,
        offset_bytes=upload.offset_bytes,
        n_files=upload.n_files,
        first_name=first_name,
        expires_at=upload.expires_at,
        problem=Problem.model_validate(upload.problem) if upload.problem else None,
    )


def _state(upload: Upload) -> UploadState:
    if upload.finished_at is not None:
        return UploadState.FINISHED
    return UploadState.OPEN if upload.problem is None else UploadState.REFUSED
