"""Queries about uploads on their way."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, delete, func, select, tuple_, update
from sqlalchemy.orm import Session, undefer

from backend.models import Experiment, File, Upload, UploadPiece
from backend.platform.places import Piece
from backend.platform.visibility import Viewer, visible_experiments
from backend.uploads.planning import Key


def find(
    session: Session, viewer: Viewer, experiment_id: UUID, upload_id: UUID, *, lock: bool = False
) -> Upload | None:
    """One upload with its files, if it is there for this person."""
    seen = visible_experiments(viewer).with_only_columns(Experiment.id)
    query = select(Upload).where(
        Upload.id == upload_id, Upload.experiment_id == experiment_id, Upload.experiment_id.in_(seen)
    )
    if lock:
        query = query.with_for_update().execution_options(populate_existing=True)
    return session.scalar(query.options(undefer(Upload.files)))


def unfinished(session: Session, experiment_id: UUID) -> Sequence[Upload]:
    """Uploads of an experiment that are open or refused, with their files, locked: nobody sends meanwhile."""
    query = select(Upload).where(Upload.experiment_id == experiment_id, Upload.finished_at.is_(None))
    return session.scalars(query.options(undefer(Upload.files)).order_by(Upload.created_at).with_for_update()).all()


def first_unfinished(session: Session, experiment_id: UUID, n: int) -> Sequence[tuple[Upload, str]]:
    """The same, only some, each with the name of its first file."""
    query = select(Upload, Upload.files[0]["name"].astext).where(
        Upload.experiment_id == experiment_id, Upload.finished_at.is_(None)
    )
    return [(row[0], str(row[1])) for row in session.execute(query.order_by(Upload.created_at, Upload.id).limit(n))]


def there(session: Session, experiment_id: UUID, keys: Iterable[Key]) -> Mapping[Key, tuple[int, str]]:
    """Size and checksum of those of these files that are here."""
    query = select(File.role, File.name, File.size_bytes, File.sha256).where(
        File.experiment_id == experiment_id, tuple_(File.role, File.name).in_(list(keys))
    )
    return {(role, name): (size_bytes, sha256) for role, name, size_bytes, sha256 in session.execute(query)}


def bytes_to_come(session: Session, experiment_id: UUID | None = None) -> int:
    """Bytes that were announced and have not arrived, of one experiment or of all."""
    query = select(func.coalesce(func.sum(Upload.size_bytes - Upload.offset_bytes), 0)).where(
        Upload.finished_at.is_(None), Upload.problem.is_(None), Upload.expires_at > func.now()
    )
    if experiment_id is not None:
        query = query.where(Upload.experiment_id == experiment_id)
    return int(session.scalar(query) or 0)


def advance(
    session: Session, upload_id: UUID, fence: int, *, offset_bytes: int, pieces: Sequence[Piece], values: dict[str, Any]
) -> bool:
    """Write down that bytes are safe; False if the upload is somebody else's now, or gone."""
    changed = session.execute(
        update(Upload)
        .where(Upload.id == upload_id, Upload.fence == fence, Upload.finished_at.is_(None))
        .values(offset_bytes=offset_bytes, **values)
        .returning(Upload.id)
        .execution_options(synchronize_session=False)
    )
    if changed.one_or_none() is None:
        return False
    start = offset_bytes - sum(piece.size_bytes for piece in pieces)
    for piece in pieces:
        session.add(UploadPiece(upload_id=upload_id, start_byte=start, size_bytes=piece.size_bytes, name=piece.name))
        start += piece.size_bytes
    return True


def pieces(session: Session, upload_id: UUID) -> list[Piece]:
    """The pieces of an upload, in the order of their bytes."""
    query = select(UploadPiece).where(UploadPiece.upload_id == upload_id).order_by(UploadPiece.start_byte)
    return [Piece(piece.name, piece.size_bytes) for piece in session.scalars(query)]


def forget_pieces(session: Session, upload_id: UUID) -> None:
    """Their index is beside them now, or they are not wanted."""
    session.execute(delete(UploadPiece).where(UploadPiece.upload_id == upload_id))


def is_held() -> ColumnElement[bool]:
    """That somebody sends it just now."""
    return func.coalesce(Upload.held_until > func.clock_timestamp(), False)


def held_ids(session: Session, experiment_id: UUID) -> set[UUID]:
    """Uploads that somebody sends just now."""
    return set(session.scalars(select(Upload.id).where(Upload.experiment_id == experiment_id, is_held())))


def in_seconds(seconds: float) -> ColumnElement[Any]:
    """A moment from now, by the database's clock."""
    return func.clock_timestamp() + timedelta(seconds=seconds)
