"""What can be done with runs."""

from collections.abc import Sequence
from typing import Any, NoReturn
from uuid import UUID

from sqlalchemy.orm import Session

from backend.experiments.service import get as get_experiment
from backend.experiments.service import get_locked
from backend.groups.quotas import demand_run
from backend.models import Run, Shard, Stage
from backend.models.lifecycle import request_cancel
from backend.models.states import ACTIVE_RUN_STATES, RUN_RULES, RunState, StackState, is_terminal
from backend.platform.audit import tell
from backend.platform.database import after_commit
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic, run_topic
from backend.platform.problems import Problem
from backend.platform.texts import unstorable
from backend.platform.trash import bytes_of_run, remove_run, throw_away
from backend.platform.visibility import MayNot, Viewer
from backend.runs import repository, schemas
from backend.runs.errors import NoSuchRun, RunActive, RunFinished, RunNotFailed
from backend.runs.progress import shown_stages
from backend.runs.repository import Done
from backend.runs.reuse import stage_reuse
from backend.stacks.errors import FramesExpired, StackNotReady
from dropflow.errors import ParametersError
from dropflow.experiment import parse_experiment
from dropflow.parameters import Parameters, parse_parameters
from dropflow.provenance import code_version
from dropflow.radius_range import radius_range_px


def get(session: Session, viewer: Viewer, run_id: UUID) -> Run:
    """One run."""
    return repository.find(session, viewer, run_id) or _absent(session, viewer, run_id)


def page(session: Session, viewer: Viewer, query: schemas.RunQuery, experiment_id: UUID | None = None) -> schemas.Runs:
    """One page of the runs of an experiment, or of all experiments."""
    if experiment_id is not None:
        get_experiment(session, viewer, experiment_id)
    found, next_cursor = repository.page(session, viewer, query, experiment_id)
    return schemas.Runs(items=shown_as(session, found), next_cursor=next_cursor)


def create(session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, document: dict[str, Any]) -> Run:
    """Plan a run: its first shard looks at the stack and makes the others."""
    parameters = read_parameters(document)
    experiment = get_locked(session, viewer, experiment_id)
    stack = experiment.stack
    if stack.state == StackState.EXPIRED:
        raise FramesExpired
    if stack.state != StackState.READY or stack.n_frames is None or stack.rows is None or stack.columns is None:
        raise StackNotReady
    n_frames = stack.n_frames
    demand_run(session, platform.settings, experiment.group)
    radius_range_px(parse_experiment(experiment.document), parameters, (stack.rows, stack.columns))
    run = Run(
        experiment_id=experiment.id,
        person_id=viewer.person_id,
        number=repository.last_number(session, experiment.id) + 1,
        parameters=parameters.model_dump(mode="json"),
        document=experiment.document,
        version=code_version(),
        stack_checksum=stack.checksum,
        stages=[
            Stage(name=name, position=position, total_frames=n_frames)
            for position, name in enumerate(schemas.StageName)
        ],
    )
    session.add(run)
    session.flush()
    shard = Shard(experiment_id=experiment.id, run_id=run.id, person_id=viewer.person_id, task="prepare")
    session.add(shard)
    session.flush()
    session.refresh(run)
    announce(session, experiment_topic(experiment.id))
    tell(session, run_id=run.id, number=run.number)
    after_commit(session, lambda: platform.queue.wake(shard.task))
    return run


def cancel(session: Session, viewer: Viewer, run_id: UUID) -> Run:
    """Ask a run to stop: what waits is taken back now, what is worked on within a frame or two.

    What it has made is removed with it, unless another run shares it.
    """
    get_locked(session, viewer, get(session, viewer, run_id).experiment_id)  # for what is removed may be shared
    run = repository.lock(session, viewer, run_id) or _absent(session, viewer, run_id)
    if is_terminal(RUN_RULES, run.state):
        raise RunFinished
    request_cancel(session, run)
    _announce(session, run)
    session.flush()
    session.refresh(run)
    return run


def retry(session: Session, platform: Platform, viewer: Viewer, run_id: UUID) -> Run:
    """Make a new run with the parameters of a failed one. What that one had done already is used again."""
    run = get(session, viewer, run_id)
    if run.state != RunState.FAILED:
        raise RunNotFailed
    return create(session, platform, viewer, run.experiment_id, run.parameters)


def reuse(session: Session, viewer: Viewer, run_id: UUID) -> schemas.Reuse:
    """What a run took over, compared with the one before."""
    run = get(session, viewer, run_id)
    before = repository.before(session, viewer, run)
    done = repository.done_frames(session, [run.id])
    made = set() if before is None else repository.stages_made(session, before.id)
    return schemas.Reuse(
        compared_with=None if before is None else before.number,
        stages=[
            stage_reuse(stage, done.get((run.id, stage.name), Done(0, 0)).reused_frames, run, before, made)
            for stage in run.stages
        ],
    )


def delete(session: Session, platform: Platform, viewer: Viewer, run_id: UUID, *, is_forever: bool = False) -> None:
    """Put a run into the trash; or remove it for good, and what it made unless another run shares it."""
    experiment_id = get(session, viewer, run_id).experiment_id
    get_locked(session, viewer, experiment_id)  # so that no new run shares a product in this moment
    run = repository.lock(session, viewer, run_id) or _absent(session, viewer, run_id)
    if run.state in ACTIVE_RUN_STATES:
        raise RunActive
    if is_forever:
        remove_run(session, run)
    else:
        throw_away(session, viewer, run, bytes_of_run(session, platform.store, run))
    _announce(session, run)


def shown_as(session: Session, runs: Sequence[Run]) -> list[schemas.Run]:
    """Runs as the API shows them; one query for the progress of any number."""
    done = repository.done_frames(session, [run.id for run in runs])
    return [
        schemas.Run(
            id=run.id,
            experiment_id=run.experiment_id,
            number=run.number,
            state=run.state,
            is_cancelling=run.cancel_requested_at is not None and not is_terminal(RUN_RULES, run.state),
            parameters=run.parameters,
            created_at=run.created_at,
            started_at=run.started_at,
            finished_at=run.finished_at,
            version=run.version,
            stages=shown_stages(run, done),
            problem=Problem.model_validate(run.problem) if run.problem else None,
            summary=run.summary,
            warnings=run.warnings,
        )
        for run in runs
    ]


def shown(session: Session, run: Run) -> schemas.Run:
    """One run as the API shows it."""
    return shown_as(session, [run])[0]


def look(platform: Platform, viewer: Viewer, run_id: UUID) -> schemas.Run:
    """One run, looked up in a transaction of its own."""
    with platform.sessions.begin() as session:
        return shown(session, get(session, viewer, run_id))


def read_parameters(document: dict[str, Any]) -> Parameters:
    """Parameters from outside, checked."""
    if problems := list(unstorable(document)):
        raise ParametersError("Please correct:", fields=problems)
    return parse_parameters(document)


def _absent(session: Session, viewer: Viewer, run_id: UUID) -> NoReturn:
    """Refuse what somebody sees and may not do with it; what they do not see is not there."""
    if repository.find(session, viewer.only_looking(), run_id) is not None:
        raise MayNot(viewer.needs)
    raise NoSuchRun


def _announce(session: Session, run: Run) -> None:
    announce(session, run_topic(run.id), experiment_topic(run.experiment_id))
