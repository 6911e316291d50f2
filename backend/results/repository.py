"""Queries about what runs made."""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from backend.models import FrameSummary, Product, Run, Shard
from backend.platform.visibility import Viewer, visible_runs


def _products(viewer: Viewer, run_id: UUID) -> Select[Product]:
    seen = visible_runs(viewer).where(Run.id == run_id).with_only_columns(Run.id)
    return select(Product).join(Shard, Shard.product_id == Product.id).where(Shard.run_id.in_(seen))


def products(session: Session, viewer: Viewer, run_id: UUID) -> Sequence[Product]:
    """What a run has made so far."""
    return session.scalars(_products(viewer, run_id).order_by(Shard.task, Shard.start_frame)).all()


def product(session: Session, viewer: Viewer, run_id: UUID, task: str, frame: int | None = None) -> Product | None:
    """What a task of a run made, of the shard that holds `frame`."""
    query = _products(viewer, run_id).where(Shard.task == task)
    if frame is not None:
        query = query.where(Shard.start_frame <= frame, Shard.stop_frame > frame)
    return session.scalar(query.limit(1))


def done(session: Session, viewer: Viewer, run_id: UUID) -> set[str]:
    """The tasks of a run that have left something."""
    return set(session.scalars(_products(viewer, run_id).with_only_columns(Shard.task).distinct()))


def sizes(session: Session, viewer: Viewer, run_id: UUID, task: str) -> list[bytes]:
    """The packed histograms of a task, as far as there are any."""
    return list(session.scalars(_summaries(viewer, run_id, task).with_only_columns(FrameSummary.sizes)))


def flow(session: Session, viewer: Viewer, run_id: UUID) -> bytes | None:
    """The packed moments of the flow."""
    return session.scalar(_summaries(viewer, run_id, "track").with_only_columns(FrameSummary.flow))


def _summaries(viewer: Viewer, run_id: UUID, task: str) -> Select[Product]:
    return (
        _products(viewer, run_id)
        .join(FrameSummary, FrameSummary.product_id == Product.id)
        .where(Shard.task == task)
        .order_by(Shard.start_frame)
    )
