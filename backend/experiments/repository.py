"""Queries about experiments."""

from collections.abc import Mapping, Sequence
from datetime import datetime
from uuid import UUID

from sqlalchemy import func, select, tuple_
from sqlalchemy.orm import Session

from backend.models import Experiment, File, Run, Shard
from backend.models.states import ACTIVE_RUN_STATES, ShardState
from backend.platform.visibility import Viewer, visible_experiments


def find(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment | None:
    """One experiment, if it is there for this person."""
    return session.scalar(visible_experiments(viewer).where(Experiment.id == experiment_id))


def lock(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment | None:
    """The same, and nobody else changes its stack, files or list of runs until this transaction ends."""
    query = (
        visible_experiments(viewer).where(Experiment.id == experiment_id).with_for_update(of=Experiment, key_share=True)
    )
    return session.scalar(query.execution_options(populate_existing=True))


def newest(
    session: Session, viewer: Viewer, n: int, after: tuple[datetime, UUID] | None = None
) -> Sequence[Experiment]:
    """At most `n` experiments, newest first, after a place in that order."""
    query = visible_experiments(viewer).order_by(Experiment.created_at.desc(), Experiment.id.desc()).limit(n)
    if after is not None:
        query = query.where(tuple_(Experiment.created_at, Experiment.id) < after)
    return session.scalars(query).all()


def files_of(session: Session, experiment_ids: Sequence[UUID]) -> Mapping[UUID, tuple[int, int]]:
    """Number and bytes of the files of each experiment that has any."""
    query = (
        select(File.experiment_id, func.count(), func.sum(File.size_bytes))
        .where(File.experiment_id.in_(experiment_ids))
        .group_by(File.experiment_id)
    )
    return {found: (n_files, int(size_bytes)) for found, n_files, size_bytes in session.execute(query)}


def indexed_frames(session: Session, experiment_ids: Sequence[UUID]) -> Mapping[UUID, int]:
    """Frames read so far, of stacks that are being indexed."""
    query = select(Shard.experiment_id, Shard.done_frames).where(
        Shard.experiment_id.in_(experiment_ids),
        Shard.task == "ingest",
        Shard.state.in_((ShardState.QUEUED, ShardState.RUNNING)),
    )
    return dict(session.execute(query).all())


def has_active_run(session: Session, experiment_id: UUID) -> bool:
    """Whether a run is queued or running."""
    query = select(Run.id).where(Run.experiment_id == experiment_id, Run.state.in_(ACTIVE_RUN_STATES)).limit(1)
    return session.scalar(query) is not None
