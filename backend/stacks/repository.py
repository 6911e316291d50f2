"""Queries about files."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import Select, delete, func, select
from sqlalchemy.orm import Session

from backend.models import Experiment, File, Import, Run, Shard, Upload
from backend.platform.pages import Order, page_of
from backend.platform.places import Place
from backend.platform.store_files import PLACED, place_of
from backend.platform.visibility import Viewer, visible_experiments
from backend.stacks.schemas import FileQuery


def files(session: Session, viewer: Viewer, experiment_id: UUID) -> Sequence[File]:
    """Files of an experiment by role and name."""
    return session.scalars(_files(viewer, experiment_id).order_by(File.role, File.name)).all()


def places(session: Session, viewer: Viewer, experiment_id: UUID, role: str) -> dict[str, Place]:
    """Where each file of one role is kept, by name."""
    asked = _files(viewer, experiment_id).where(File.role == role).with_only_columns(File.name, *PLACED)
    return {row.name: place_of(row) for row in session.execute(asked)}


_BY_NAME = (File.role.expression, File.name.expression)
_KEYS = {"name": _BY_NAME, "size_bytes": (File.size_bytes.expression, *_BY_NAME)}


def page(session: Session, viewer: Viewer, query: FileQuery, experiment_id: UUID) -> tuple[Sequence[File], str | None]:
    """The files of one page, and the cursor of the next."""
    order = Order(query.sort, _KEYS[query.sort.removeprefix("-")], query.sort.startswith("-"))
    asked = _files(viewer, experiment_id)
    if query.role is not None:
        asked = asked.where(File.role == query.role)
    if query.q is not None:
        asked = asked.where(File.name.icontains(query.q, autoescape=True))
    return page_of(session, asked, order, limit=query.limit, cursor=query.cursor)


def _files(viewer: Viewer, experiment_id: UUID) -> Select[File]:
    seen = visible_experiments(viewer).with_only_columns(Experiment.id)
    return select(File).where(File.experiment_id == experiment_id, File.experiment_id.in_(seen))


def file(session: Session, viewer: Viewer, experiment_id: UUID, file_id: UUID) -> File | None:
    """One file, if it is there for this person."""
    return session.scalar(_files(viewer, experiment_id).where(File.id == file_id))


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
    """Forget the work of importing and indexing; a worker that holds it finds its lease gone."""
    session.execute(delete(Import).where(Import.experiment_id == experiment_id))
    session.execute(delete(Shard).where(Shard.experiment_id == experiment_id, Shard.run_id.is_(None)))


def missing(session: Session, experiment_id: UUID) -> tuple[int, int]:
    """Number of files that were announced but have not arrived, and how many bytes of them have not."""
    to_come = func.sum(Upload.size_bytes - Upload.offset_bytes)
    query = select(func.coalesce(func.sum(Upload.n_files), 0), func.coalesce(to_come, 0))
    n_files, n_bytes = session.execute(
        query.where(Upload.experiment_id == experiment_id, Upload.finished_at.is_(None), Upload.problem.is_(None))
    ).one()
    return int(n_files), int(n_bytes)


def missing_of_import(session: Session, experiment_id: UUID) -> tuple[int, int]:
    """The same of an import that broke off."""
    begun = session.get(Import, experiment_id)
    if begun is None or begun.finished_at is not None:
        return 0, 0
    n_there = session.scalar(select(func.count(File.id)).where(File.experiment_id == experiment_id)) or 0
    return max(begun.n_files - n_there, 0), max(begun.size_bytes - size_bytes(session, experiment_id), 0)


def end_uploads(session: Session, experiment_id: UUID) -> list[str]:
    """Forget all uploads. Returns the keys of bytes that no file is made of."""
    ended = delete(Upload).where(Upload.experiment_id == experiment_id).returning(Upload.store_key, Upload.finished_at)
    return [key for key, finished_at in session.execute(ended) if finished_at is None]
