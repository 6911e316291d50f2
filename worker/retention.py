"""What goes by time: raw frames of which all is known go to the trash, and what lies there for long is removed."""

from datetime import timedelta
from typing import Any
from uuid import UUID

import structlog
from sqlalchemy import ColumnElement, exists, func, select
from sqlalchemy.orm import Session

from backend.models import Experiment, Run, Stack
from backend.models.states import ACTIVE_RUN_STATES, STACK_RULES, RunState, StackState, rule
from backend.platform.events import announce, experiment_topic
from backend.platform.trash import bytes_of_frames, remove_experiment, remove_frames, remove_run, throw_away
from worker.context import Context
from worker.leases import LeaseLost
from worker.outcomes import lock_experiment

_MOST_AT_ONCE = 100
log = structlog.get_logger()


def retain(context: Context) -> None:
    """Look once."""
    _expire_frames(context)
    _empty_trash(context)


def _expire_frames(context: Context) -> None:
    """Frames whose last run was completed long ago, and of which nobody has asked for another since."""
    after_s = context.settings.frames_expire_s
    if after_s is None:
        return
    runs = select(func.max(Run.finished_at)).where(Run.experiment_id == Stack.experiment_id)
    last = runs.where(Run.state == RunState.COMPLETED, Run.trashed_at.is_(None)).scalar_subquery()
    active = exists().where(Run.experiment_id == Stack.experiment_id, Run.state.in_(ACTIVE_RUN_STATES))
    is_over = (Stack.state == StackState.READY, last < _ago(after_s), ~active)
    for experiment_id in _ids(context, select(Stack.experiment_id).where(*is_over)):
        with context.sessions.begin() as session:
            experiment = _locked(session, experiment_id)
            still = select(Stack.experiment_id).where(Stack.experiment_id == experiment_id, *is_over)
            if experiment is None or experiment.trashed_at is not None or session.scalar(still) is None:
                continue
            experiment.stack.state = rule(STACK_RULES, "expire").target
            throw_away(session, None, experiment.stack, bytes_of_frames(session, experiment))
            announce(session, experiment_topic(experiment_id))
            log.info("frames expired", experiment=str(experiment_id))


def _empty_trash(context: Context) -> None:
    keeps_s = context.settings.trash_keeps_s
    if keeps_s is None:
        return
    before = _ago(keeps_s)
    for experiment_id in _ids(context, select(Experiment.id).where(Experiment.trashed_at < before)):
        with context.sessions.begin() as session:
            experiment = _locked(session, experiment_id)
            if experiment is not None and experiment.trashed_at is not None:
                remove_experiment(session, experiment)
    for experiment_id in _ids(context, select(Stack.experiment_id).where(Stack.trashed_at < before)):
        with context.sessions.begin() as session:
            experiment = _locked(session, experiment_id)
            if experiment is not None and experiment.stack.trashed_at is not None:
                remove_frames(session, experiment.stack)
                announce(session, experiment_topic(experiment_id))
    for experiment_id in _ids(context, select(Run.experiment_id).where(Run.trashed_at < before).distinct()):
        with context.sessions.begin() as session:
            if _locked(session, experiment_id) is not None:
                over = select(Run).where(Run.experiment_id == experiment_id, Run.trashed_at < before)
                for run in session.scalars(over).all():
                    remove_run(session, run)


def _ids(context: Context, query: Any) -> list[UUID]:
    with context.sessions.begin() as session:
        return list(session.scalars(query.limit(_MOST_AT_ONCE)))


def _locked(session: Session, experiment_id: UUID) -> Experiment | None:
    try:
        return lock_experiment(session, experiment_id)
    except LeaseLost:
        return None  # it was removed meanwhile


def _ago(seconds: float) -> ColumnElement[Any]:
    return func.now() - timedelta(seconds=seconds)
