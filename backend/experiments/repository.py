"""Queries about experiments."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Text, exists, func, select
from sqlalchemy.orm import Session

from backend.experiments.schemas import ExperimentQuery
from backend.models import Experiment, File, Import, Run, Shard, Stack
from backend.models.states import ACTIVE_RUN_STATES, ShardState, StackState
from backend.platform.pages import Order, page_of
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


_NAME = func.lower(Experiment.document["name"].astext, type_=Text())
_KEYS: dict[str, ColumnElement[Any]] = {
    "created_at": Experiment.created_at.expression,
    "updated_at": Experiment.updated_at.expression,
    "name": _NAME,
}


def page(session: Session, viewer: Viewer, query: ExperimentQuery) -> tuple[Sequence[Experiment], str | None]:
    """The experiments of one page, and the cursor of the next."""
    key = _KEYS[query.sort.removeprefix("-")]
    order = Order(query.sort, (key, Experiment.id.expression), query.sort.startswith("-"))
    asked = visible_experiments(viewer).where(*_wanted(query))
    return page_of(session, asked, order, limit=query.limit, cursor=query.cursor)


def _wanted(query: ExperimentQuery) -> Iterator[ColumnElement[bool]]:
    """One condition for each filter that is given."""
    for word in (query.q or "").split():
        yield func.concat_ws(
            "\n", *(Experiment.document[field].astext for field in ("name", "notes", "tags"))
        ).icontains(word, autoescape=True)
    if query.tag is not None:
        yield Experiment.document["tags"].contains([query.tag])
    if query.group_id is not None:
        yield Experiment.group_id == query.group_id
    if query.stack_state is not None:
        yield Experiment.stack.has(Stack.state == query.stack_state)
    if query.run_state is not None:
        yield exists().where(Run.experiment_id == Experiment.id, Run.state == query.run_state)
    if query.created_from is not None:
        yield Experiment.created_at >= query.created_from
    if query.created_before is not None:
        yield Experiment.created_at < query.created_before


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


def open_imports(session: Session, experiment_ids: Sequence[UUID]) -> Mapping[UUID, Import]:
    """Imports that are on their way."""
    query = (
        select(Import)
        .join(Stack, Stack.experiment_id == Import.experiment_id)
        .where(
            Import.experiment_id.in_(experiment_ids),
            Import.finished_at.is_(None),
            Stack.state == StackState.INDEXING,
        )
    )
    return {found.experiment_id: found for found in session.scalars(query)}


def has_active_run(session: Session, experiment_id: UUID) -> bool:
    """Whether a run is queued or running."""
    query = select(Run.id).where(Run.experiment_id == experiment_id, Run.state.in_(ACTIVE_RUN_STATES)).limit(1)
    return session.scalar(query) is not None
