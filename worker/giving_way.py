"""Tracking gives way after a checkpoint when somebody else waits: hours of one film hold up nobody's minutes.

Sequential work has few processes, and a long film would keep one for as long as it takes. So whoever tracks
looks, after each state that was saved, whether another person's film waits; then the shard goes back on the list, and
its turn comes again as whose turn it is is decided (`worker.turns`). It goes on from that very state, on this machine.
"""

import time
from datetime import timedelta
from pathlib import Path

from sqlalchemy import func, select
from sqlalchemy.orm import aliased

from backend.models import Run, Shard
from backend.models.states import ACTIVE_RUN_STATES, ShardState
from worker.context import Context
from worker.leases import MAX_ATTEMPTS, Lease
from worker.plan import Task

TURN_S = 60.0
"""So long one keeps the process before others are looked for."""
_WAITING_S = 5.0
"""Who waits for less may be about to be taken by another process."""


class GaveWay(Exception):
    """The state is saved, and somebody else waits."""


class Turn:
    """The lease of tracking as its `dropflow.progress.Progress`: raises `GaveWay` where that costs nothing."""

    def __init__(self, context: Context, lease: Lease, checkpoint: Path) -> None:
        self._context, self._lease, self._checkpoint = context, lease, checkpoint
        self._began_s = time.monotonic()
        self._saved_ns = self._last_saved_ns()

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Note progress; right after a state was saved, look who waits."""
        self._lease(stage, done, total)
        saved_ns = self._last_saved_ns()
        if saved_ns == self._saved_ns:
            return
        self._saved_ns = saved_ns
        if done < total and time.monotonic() - self._began_s > TURN_S and self._is_awaited():
            raise GaveWay

    def _last_saved_ns(self) -> int:
        return self._checkpoint.stat().st_mtime_ns if self._checkpoint.exists() else 0

    def _is_awaited(self) -> bool:
        with self._context.sessions.begin() as session:
            own = aliased(Shard)  # else the question would be about the very shard that waits
            person = select(own.person_id).where(own.id == self._lease.claim.shard_id).scalar_subquery()
            waiting = (
                select(Shard.id)
                .join(Run, Run.id == Shard.run_id)
                .where(
                    Shard.task == Task.TRACK,
                    Shard.state == ShardState.QUEUED,
                    Shard.attempts < MAX_ATTEMPTS,
                    Shard.person_id.is_distinct_from(person),
                    Shard.created_at < func.clock_timestamp() - timedelta(seconds=_WAITING_S),
                    Run.state.in_(ACTIVE_RUN_STATES),
                    Run.cancel_requested_at.is_(None),
                )
                .limit(1)
            )
            return session.scalar(waiting) is not None
