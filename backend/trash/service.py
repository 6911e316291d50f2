"""What can be done with the trash: look, bring back, remove for good."""

from datetime import timedelta
from uuid import UUID

from sqlalchemy.orm import Session

from backend.experiments.errors import NoSuchExperiment
from backend.experiments.service import refuse_during_run
from backend.models import Experiment, Run
from backend.models.states import STACK_RULES, StackState, rule
from backend.models.trashed import Trashed
from backend.platform.audit import tell
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic
from backend.platform.settings import Settings
from backend.platform.trash import (
    bring_back,
    bytes_of_frames,
    remove_experiment,
    remove_frames,
    remove_run,
    throw_away,
)
from backend.platform.visibility import MayNot, Viewer
from backend.runs.errors import NoSuchRun
from backend.stacks.errors import StackNotReady
from backend.trash import repository
from backend.trash.errors import NotInTrash
from backend.trash.schemas import Emptied, Kind, Trash, TrashedThing


def look(session: Session, platform: Platform, viewer: Viewer) -> Trash:
    """All that lies in the trash."""
    items = [
        *(
            _shown(platform.settings, Kind.EXPERIMENT, thing, thing)
            for thing in repository.experiments(session, viewer)
        ),
        *(_shown(platform.settings, Kind.RUN, thing, thing.experiment) for thing in repository.runs(session, viewer)),
        *(
            _shown(platform.settings, Kind.FRAMES, thing.stack, thing)
            for thing in repository.with_frames_in_trash(session, viewer)
        ),
    ]
    items.sort(key=lambda item: item.trashed_at, reverse=True)
    return Trash(items=items, size_bytes=sum(item.size_bytes for item in items))


def restore_experiment(session: Session, viewer: Viewer, experiment_id: UUID) -> None:
    """Bring an experiment back."""
    experiment = _experiment(session, viewer, experiment_id)
    bring_back(_in_trash(experiment))
    _changed(session, experiment)


def remove_experiment_forever(session: Session, viewer: Viewer, experiment_id: UUID) -> None:
    """Remove an experiment that lies in the trash."""
    experiment = _experiment(session, viewer, experiment_id)
    _in_trash(experiment)
    _changed(session, experiment)
    remove_experiment(session, experiment)


def restore_run(session: Session, viewer: Viewer, run_id: UUID) -> None:
    """Bring a run back."""
    run, experiment = _run(session, viewer, run_id)
    bring_back(_in_trash(run))
    _changed(session, experiment)


def remove_run_forever(session: Session, viewer: Viewer, run_id: UUID) -> None:
    """Remove a run that lies in the trash."""
    run, experiment = _run(session, viewer, run_id)
    _in_trash(run)
    remove_run(session, run)
    _changed(session, experiment)


def throw_frames_away(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    """Put the frames of an experiment into the trash; its runs and their results stay."""
    experiment = _experiment(session, viewer, experiment_id)
    if experiment.trashed_at is not None:
        raise NoSuchExperiment
    if experiment.stack.state != StackState.READY:
        raise StackNotReady
    refuse_during_run(session, experiment, "changed")
    experiment.stack.state = rule(STACK_RULES, "expire").target
    throw_away(session, viewer, experiment.stack, bytes_of_frames(session, experiment))
    _changed(session, experiment)
    return experiment


def restore_frames(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    """Bring the frames of an experiment back."""
    experiment = _experiment(session, viewer, experiment_id)
    bring_back(_in_trash(experiment.stack))
    experiment.stack.state = rule(STACK_RULES, "restore").target
    _changed(session, experiment)
    return experiment


def remove_frames_forever(session: Session, viewer: Viewer, experiment_id: UUID) -> None:
    """Remove frames that lie in the trash."""
    experiment = _experiment(session, viewer, experiment_id)
    _in_trash(experiment.stack)
    remove_frames(session, experiment.stack)
    _changed(session, experiment)


def empty(session: Session, platform: Platform, viewer: Viewer) -> Emptied:
    """Remove all that lies in the trash of the groups in which this person may."""
    trash = look(session, platform, viewer)
    for item in trash.items:
        if item.kind is Kind.EXPERIMENT:
            remove_experiment_forever(session, viewer, item.experiment_id)
        elif item.kind is Kind.FRAMES:
            remove_frames_forever(session, viewer, item.experiment_id)
        elif item.run_id is not None:
            remove_run_forever(session, viewer, item.run_id)
    return Emptied(n_items=len(trash.items), size_bytes=trash.size_bytes)


def _experiment(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    found = repository.experiment(session, viewer, experiment_id)
    if found is None:
        if repository.experiment(session, viewer.only_looking(), experiment_id) is not None:
            raise MayNot(viewer.needs)
        raise NoSuchExperiment
    return found


def _run(session: Session, viewer: Viewer, run_id: UUID) -> tuple[Run, Experiment]:
    run = repository.run(session, viewer, run_id)
    if run is None:
        if repository.run(session, viewer.only_looking(), run_id) is not None:
            raise MayNot(viewer.needs)
        raise NoSuchRun
    experiment = _experiment(session, viewer, run.experiment_id)  # locked, for what it made may be shared
    if experiment.trashed_at is not None:
        raise NoSuchRun
    session.refresh(run)
    return run, experiment


def _in_trash(thing: Trashed) -> Trashed:
    if thing.trashed_at is None:
        raise NotInTrash
    return thing


def _changed(session: Session, experiment: Experiment) -> None:
    tell(session, experiment_id=experiment.id, name=experiment.document["name"])
    announce(session, experiment_topic(experiment.id))
    session.flush()


def _shown(settings: Settings, kind: Kind, thing: Trashed, experiment: Experiment) -> TrashedThing:
    assert thing.trashed_at is not None  # noqa: S101 - the queries say so
    keeps_s = settings.trash_keeps_s
    return TrashedThing(
        kind=kind,
        experiment_id=experiment.id,
        run_id=thing.id if isinstance(thing, Run) else None,
        name=str(experiment.document["name"]),
        number=thing.number if isinstance(thing, Run) else None,
        group=experiment.group.name,
        size_bytes=thing.trashed_bytes,
        trashed_at=thing.trashed_at,
        trashed_by=thing.trashed_by,
        goes_at=None if keeps_s is None else thing.trashed_at + timedelta(seconds=keeps_s),
    )
