"""Queries about the trash."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy.orm import Session

from backend.models import Experiment, Run, Stack
from backend.platform.visibility import Viewer, visible_experiments, visible_runs

_MOST = 1000


def experiments(session: Session, viewer: Viewer) -> Sequence[Experiment]:
    """Experiments in the trash."""
    query = visible_experiments(viewer, in_trash=True).order_by(Experiment.trashed_at.desc()).limit(_MOST)
    return session.scalars(query).all()


def runs(session: Session, viewer: Viewer) -> Sequence[Run]:
    """Runs in the trash, of experiments that are not."""
    return session.scalars(visible_runs(viewer, in_trash=True).order_by(Run.trashed_at.desc()).limit(_MOST)).all()


def with_frames_in_trash(session: Session, viewer: Viewer) -> Sequence[Experiment]:
    """Experiments whose frames alone are in the trash."""
    query = visible_experiments(viewer).where(Experiment.stack.has(Stack.trashed_at.is_not(None))).limit(_MOST)
    return session.scalars(query).all()


def experiment(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment | None:
    """One experiment, in the trash or not, locked."""
    query = visible_experiments(viewer, in_trash=None).where(Experiment.id == experiment_id)
    locked = query.with_for_update(of=Experiment, key_share=True)
    return session.scalar(locked.execution_options(populate_existing=True))


def run(session: Session, viewer: Viewer, run_id: UUID) -> Run | None:
    """One run, in the trash or not."""
    return session.scalar(visible_runs(viewer, in_trash=None).where(Run.id == run_id))
