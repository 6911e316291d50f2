"""/trash."""

from http import HTTPStatus
from uuid import UUID

from fastapi import APIRouter

from backend.experiments.errors import NoSuchExperiment, RunActive
from backend.experiments.schemas import Experiment
from backend.experiments.service import shown
from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.runs.errors import NoSuchRun
from backend.stacks.errors import StackNotReady
from backend.trash import service
from backend.trash.errors import NotInTrash
from backend.trash.schemas import Emptied, Trash

router = APIRouter(tags=["trash"])

_OF_EXPERIMENT = responses(NoSuchExperiment, NotInTrash, InvalidRequest)
_OF_RUN = responses(NoSuchRun, NotInTrash, InvalidRequest)


@router.get("/trash")
def trash_look(session: SessionDependency, platform: PlatformDependency, viewer: ViewerDependency) -> Trash:
    """Look at what was deleted in your groups and is not gone yet: it still takes room."""
    return service.look(session, platform, viewer)


@router.delete("/trash")
def trash_empty(session: SessionDependency, platform: PlatformDependency, viewer: EditorDependency) -> Emptied:
    """Remove for good all that lies in the trash of the groups that you may edit."""
    return service.empty(session, platform, viewer)


@router.post("/trash/experiments/{experiment_id}/restore", status_code=HTTPStatus.NO_CONTENT, responses=_OF_EXPERIMENT)
def trash_restore_experiment(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> None:
    """Bring an experiment back with all that belongs to it."""
    service.restore_experiment(session, viewer, experiment_id)


@router.delete("/trash/experiments/{experiment_id}", status_code=HTTPStatus.NO_CONTENT, responses=_OF_EXPERIMENT)
def trash_remove_experiment(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> None:
    """Remove an experiment in the trash for good."""
    service.remove_experiment_forever(session, viewer, experiment_id)


@router.post("/trash/runs/{run_id}/restore", status_code=HTTPStatus.NO_CONTENT, responses=_OF_RUN)
def trash_restore_run(session: SessionDependency, viewer: EditorDependency, run_id: UUID) -> None:
    """Bring a run back with its results."""
    service.restore_run(session, viewer, run_id)


@router.delete("/trash/runs/{run_id}", status_code=HTTPStatus.NO_CONTENT, responses=_OF_RUN)
def trash_remove_run(session: SessionDependency, viewer: EditorDependency, run_id: UUID) -> None:
    """Remove a run in the trash for good."""
    service.remove_run_forever(session, viewer, run_id)


@router.delete(
    "/experiments/{experiment_id}/frames",
    responses=responses(NoSuchExperiment, StackNotReady, RunActive, InvalidRequest),
)
def frames_delete(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> Experiment:
    """Put the raw frames into the trash. Runs and results stay; new runs need the frames back."""
    return shown(session, viewer, service.throw_frames_away(session, viewer, experiment_id))


@router.post("/trash/frames/{experiment_id}/restore", responses=_OF_EXPERIMENT)
def trash_restore_frames(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> Experiment:
    """Bring the raw frames of an experiment back."""
    return shown(session, viewer, service.restore_frames(session, viewer, experiment_id))


@router.delete("/trash/frames/{experiment_id}", status_code=HTTPStatus.NO_CONTENT, responses=_OF_EXPERIMENT)
def trash_remove_frames(session: SessionDependency, viewer: EditorDependency, experiment_id: UUID) -> None:
    """Remove the raw frames in the trash for good; results stay."""
    service.remove_frames_forever(session, viewer, experiment_id)
