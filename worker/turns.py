"""Whose turn it is: workers are shared between people, not between runs.

The person with the least running work comes first, then the one who was served longest ago; among the shards of one
person the oldest run comes first. So a person with a hundred runs takes what others leave, and never all.
"""

from collections.abc import Sequence
from uuid import UUID

from sqlalchemy import ScalarSelect, case, func, select
from sqlalchemy.orm import aliased

from backend.models import Run, Shard
from backend.models.states import ShardState
from worker.leases import is_wanted
from worker.plan import Task


def whose_turn(tasks: Sequence[Task]) -> ScalarSelect[UUID]:
    """The shard of one of `tasks` to be done next, locked: others who ask at the same time get the one after."""
    waiting = (Shard.state == ShardState.QUEUED, Shard.task.in_(tasks), is_wanted())
    people = select(Shard.person_id).where(*waiting).distinct().cte("people")
    other = aliased(Shard)
    theirs = other.person_id.is_not_distinct_from(people.c.person_id)
    n_running = select(func.count()).where(theirs, other.state == ShardState.RUNNING).scalar_subquery()
    served_at = select(func.max(other.started_at)).where(theirs).scalar_subquery()
    turns = select(people.c.person_id, n_running.label("n_running"), served_at.label("served_at")).cte("turns")
    return (
        select(Shard.id)
        .join(turns, turns.c.person_id.is_not_distinct_from(Shard.person_id))
        .outerjoin(Run, Run.id == Shard.run_id)
        .where(*waiting)
        .order_by(
            turns.c.n_running,
            turns.c.served_at.nulls_first(),
            func.coalesce(Run.created_at, Shard.created_at),
            case((Shard.task == Task.DETECT, 1), else_=0),
            Shard.start_frame,
        )
        .limit(1)
        .with_for_update(of=Shard, skip_locked=True, key_share=True)
        .scalar_subquery()
    )
