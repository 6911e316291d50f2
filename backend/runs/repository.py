"""Queries about runs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from uuid import UUID

from sqlalchemy import ColumnElement, case, func, or_, select
from sqlalchemy.dialects.postgresql import distinct_on
from sqlalchemy.orm import Session

from backend.models import Run, Shard
from backend.models.states import RunState, ShardState
from backend.platform.pages import Order, page_of
from backend.platform.visibility import Viewer, visible_runs
from backend.runs.schemas import RunQuery

_A_MOMENT_S = 10.0


def find(session: Session, viewer: Viewer, run_id: UUID) -> Run | None:
    """One run, if it is there for this person."""
    return session.scalar(visible_runs(viewer).where(Run.id == run_id))


def lock(session: Session, viewer: Viewer, run_id: UUID) -> Run | None:
    """The same, and nobody else changes its state until this transaction ends."""
    query = visible_runs(viewer).where(Run.id == run_id).with_for_update(of=Run, key_share=True)
    return session.scalar(query.execution_options(populate_existing=True))


def page(
    session: Session, viewer: Viewer, query: RunQuery, experiment_id: UUID | None
) -> tuple[Sequence[Run], str | None]:
    """The runs of one page, of one experiment or of all, and the cursor of the next."""
    keys = (Run.created_at.expression, Run.id.expression)
    order = Order(query.sort, keys, query.sort.startswith("-"))
    asked = visible_runs(viewer).where(*_wanted(query, experiment_id))
    return page_of(session, asked, order, limit=query.limit, cursor=query.cursor)


def _wanted(query: RunQuery, experiment_id: UUID | None) -> Iterator[ColumnElement[bool]]:
    """One condition for each filter that is given."""
    if experiment_id is not None:
        yield Run.experiment_id == experiment_id
    if query.state is not None:
        yield Run.state == query.state
    if query.created_from is not None:
        yield Run.created_at >= query.created_from
    if query.created_before is not None:
        yield Run.created_at < query.created_before


def latest(session: Session, viewer: Viewer, experiment_ids: Sequence[UUID]) -> Mapping[UUID, Run]:
    """The latest run of each experiment that has any."""
    query = (
        visible_runs(viewer.only_looking())
        .where(Run.experiment_id.in_(experiment_ids))
        .ext(distinct_on(Run.experiment_id))
        .order_by(Run.experiment_id, Run.number.desc())
    )
    return {run.experiment_id: run for run in session.scalars(query)}


def n_runs(session: Session, viewer: Viewer, experiment_ids: Sequence[UUID]) -> Mapping[UUID, int]:
    """How many runs each experiment has that has any."""
    query = (
        visible_runs(viewer.only_looking())
        .where(Run.experiment_id.in_(experiment_ids))
        .with_only_columns(Run.experiment_id, func.count())
        .group_by(Run.experiment_id)
    )
    return dict(session.execute(query).all())


def last_number(session: Session, experiment_id: UUID) -> int:
    """The highest number of a run of this experiment, 0 if there is none."""
    return session.scalar(select(func.max(Run.number)).where(Run.experiment_id == experiment_id)) or 0


@dataclass(frozen=True)
class Done:
    """Frames that are done of one stage, and how fast that went."""

    frames: int
    reused_frames: int
    n_busy: int = 0
    """Processes that work on it, or did a moment ago."""
    n_samples: int = 0
    """Stretches of work that were timed."""
    n_timed: float = 0.0
    """Their frames."""
    seconds_per_frame: float | None = None
    """Of one process."""
    seconds_per_frame_std: float | None = None
    """How much that differs from stretch to stretch."""


def done_frames(session: Session, run_ids: Sequence[UUID]) -> Mapping[tuple[UUID, str], Done]:
    """Frames that are done by run and task."""
    reused = func.sum(case((Shard.is_reused, Shard.done_frames), else_=0))
    moment_ago = func.clock_timestamp() - timedelta(seconds=_A_MOMENT_S)
    is_busy = or_(Shard.state == ShardState.RUNNING, Shard.finished_at > moment_ago)
    timed = case((Shard.n_paces > 0, Shard.done_frames), else_=0)
    squared = func.power(Shard.seconds_per_frame, 2) + func.power(Shard.seconds_per_frame_std, 2)
    query = (
        select(
            Shard.run_id,
            Shard.task,
            func.sum(Shard.done_frames),
            reused,
            func.count(Shard.holder.distinct()).filter(is_busy),
            func.sum(Shard.n_paces),
            func.sum(timed),
            func.sum(timed * Shard.seconds_per_frame),
            func.sum(timed * squared),
        )
        .where(Shard.run_id.in_(run_ids))
        .group_by(Shard.run_id, Shard.task)
    )
    return {(run, task): _done(*numbers) for run, task, *numbers in session.execute(query)}


def _done(
    frames: int, reused: int, n_busy: int, n_samples: int, n_timed: int, seconds: float | None, squares: float | None
) -> Done:
    if not n_timed or seconds is None or squares is None:
        return Done(int(frames), int(reused), n_busy)
    mean_s = seconds / n_timed
    std_s = max(squares / n_timed - mean_s**2, 0.0) ** 0.5
    return Done(int(frames), int(reused), n_busy, int(n_samples), float(n_timed), mean_s, std_s)


def before(session: Session, viewer: Viewer, run: Run) -> Run | None:
    """The run of the same experiment before this one, of those that were not cancelled."""
    earlier = (Run.experiment_id == run.experiment_id, Run.number < run.number, Run.state != RunState.CANCELLED)
    return session.scalar(visible_runs(viewer).where(*earlier).order_by(Run.number.desc()).limit(1))


def stages_made(session: Session, run_id: UUID) -> set[str]:
    """The tasks of a run all of whose products are there."""
    query = (
        select(Shard.task)
        .where(Shard.run_id == run_id)
        .group_by(Shard.task)
        .having(func.bool_and(Shard.product_id.is_not(None)))
    )
    return set(session.scalars(query))
