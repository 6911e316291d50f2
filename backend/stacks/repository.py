"""Queries about files."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import delete, func, select, tuple_
from sqlalchemy.orm import Session

from backend.models import Experiment, File, Run, Shard
from backend.platform.visibility import Viewer, visible_experiments


def files(
    session: Session, viewer: Viewer, experiment_id: UUID, n: int | None = None, after: tuple[str, str] | None = None
) -> Sequence[File]:
    """Files of an experiment by role and name, after a place in that order."""
    seen = visible_experiments(viewer).with_only_columns(Experiment.id)
    query = select(File).where(File.experiment_id == experiment_id, File.experiment_id.in_(seen))
    if after is not None:
        query = query.where(tuple_(File.role, File.name) > after)
    return session.scalars(query.order_by(File.role, File.name).limit(n)).all()


def named(session: Session, experiment_id: UUID, role: str, name: str) -> File | None:
    """The file of this name, if it came before."""
    return session.scalar(select(File).filter_by(experiment_id=experiment_id, role=role, name=name))


def size_bytes(session: Session, experiment_id: UUID) -> int:
    """Bytes of all files of an experiment."""
    return int(
        session.scalar(select(func.coalesce(func.sum(File.size_bytes), 0)).filter_by(experiment_id=experiment_id)) or 0
    )


def has_runs(session: Session, experiment_id: UUID) -> bool:
    """Whether any run was made from these frames."""
    return session.scalar(select(Run.id).filter_by(experiment_id=experiment_id).limit(1)) is not None


def delete_ingest(session: Session, experiment_id: UUID) -> None:
    """Forget the work of indexing; a worker that holds it finds its lease gone."""
    session.execute(delete(Shard).where(Shard.experiment_id == experiment_id, Shard.run_id.is_(None)))
