"""Whose turn it is: workers are shared between people, not between runs.

The person with the least running work comes first, then the one who was served longest ago; among the shards of one
person the oldest run comes first. So a person with a hundred runs takes what others leave, and never all.

What this costs grows with the number of active runs, not with that of waiting shards, of which there may be a million.
"""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import CTE, ColumnElement, ScalarSelect, case, func, or_, select, true
from sqlalchemy.orm import aliased
from sqlalchemy.sql import Select

from backend.models import Run, Shard
from backend.models.states import ACTIVE_RUN_STATES, ShardState
from worker.leases import MAX_ATTEMPTS
from worker.plan import Task


def whose_turn(tasks: Sequence[Task], machine: str = "") -> ScalarSelect[UUID]:
    """The shard of one of `tasks` to be done next on a machine, locked: others who ask meanwhile get the one after."""
    is_free = or_(Shard.kept_until.is_(None), Shard.kept_on == machine, Shard.kept_until < func.clock_timestamp())
    waiting = (Shard.state == ShardState.QUEUED, Shard.task.in_(tasks), Shard.attempts < MAX_ATTEMPTS, is_free)
    # COALESCE does not look for the second where there is the first.
    return select(func.coalesce(_of_runs(*waiting), _of_no_run(*waiting))).scalar_subquery()


def _of_runs(*waiting: ColumnElement[bool]) -> ScalarSelect[UUID]:
    """The first waiting shard of the first run that has one."""
    is_active = (Run.state.in_(ACTIVE_RUN_STATES), Run.cancel_requested_at.is_(None))
    people = _served(select(Run.person_id).where(*is_active))
    runs = (
        select(Run.id)
        .join(people, people.c.person_id.is_not_distinct_from(Run.person_id))
        .where(*is_active)
        .order_by(people.c.n_running, people.c.served_at.nulls_first(), Run.created_at, Run.id)
        .cte("runs")
    )
    # A nested loop goes through the runs in their order and, for LIMIT 1, ends at the first that has a shard: no
    # second one is locked. Were the order ever lost, a turn would be unfair, but no shard done twice.
    first = (
        select(Shard.id)
        .where(Shard.run_id == runs.c.id, *waiting)
        .order_by(case((Shard.task == Task.DETECT, 1), else_=0), Shard.start_frame)
        .limit(1)
        .with_for_update(of=Shard, skip_locked=True, key_share=True)
        .lateral("first")
    )
    return select(first.c.id).select_from(runs).join(first, true()).limit(1).scalar_subquery()


def _of_no_run(*waiting: ColumnElement[bool]) -> ScalarSelect[UUID]:
    """The same for what belongs to no run: reading the frames of a stack."""
    belongs_to_none = (Shard.run_id.is_(None), *waiting)
    people = _served(select(Shard.person_id).where(*belongs_to_none))
    return (
        select(Shard.id)
        .join(people, people.c.person_id.is_not_distinct_from(Shard.person_id))
        .where(*belongs_to_none)
        .order_by(people.c.n_running, people.c.served_at.nulls_first(), Shard.created_at)
        .limit(1)
        .with_for_update(of=Shard, skip_locked=True, key_share=True)
        .scalar_subquery()
    )


def _served(whose: Select[Any]) -> CTE:
    """Each person of `whose`, with how much of theirs runs and when they were last served."""
    people = whose.distinct().subquery()
    other = aliased(Shard)
    # Two questions instead of IS NOT DISTINCT FROM, which no index answers.
    known, unknown = other.person_id == people.c.person_id, other.person_id.is_(None)

    def of_theirs(what: ColumnElement[Any], *conditions: ColumnElement[bool]) -> ColumnElement[Any]:
        asked = [select(what).where(theirs, *conditions).scalar_subquery() for theirs in (known, unknown)]
        return case((people.c.person_id.is_not(None), asked[0]), else_=asked[1])

    served = select(
        people.c.person_id,
        of_theirs(func.count(other.id), other.state == ShardState.RUNNING).label("n_running"),
        of_theirs(func.max(other.started_at)).label("served_at"),
    ).cte()
    return served.prefix_with("MATERIALIZED")  # asked once a person, not once a run
