"""What the main process of a worker looks at every few seconds: processes of this machine that died, or hang.

Without it the work of a killed process would wait for its lease to end, and a process that hangs would keep its place.
"""

import os
import socket
import threading
from pathlib import Path

import structlog
from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from backend.models import Shard
from backend.models.states import ShardState
from backend.platform.reasons import reason_of
from worker.context import Context, make_context
from worker.heartbeat import end_silent
from worker.leases import MAX_ATTEMPTS, release

_LEASES = 2.0
"""A process that was silent for so many leases hangs."""
log = structlog.get_logger()


def watch(context: Context) -> None:
    """Look once."""
    main_process = os.getpid()
    for child in end_silent(context.settings.work_dir, main_process, _LEASES * context.settings.lease_s):
        log.warning("process hung and was killed", process=child)
    n_given_back = give_back_of_the_dead(context)
    if n_given_back:
        log.warning("processes died at work", shards_given_back=n_given_back)


def give_back_of_the_dead(context: Context) -> int:
    """Give back what processes of this machine held that are no more. Returns how many shards.

    After the last try the lease runs out instead, and the reconciler ends the run with the cause.
    """
    here = socket.gethostname()
    with context.sessions.begin() as session:
        query = select(Shard.holder).where(Shard.state == ShardState.RUNNING, Shard.holder.like(f"{here}:%"))
        holders = {str(holder) for holder in session.scalars(query)}
        dead = [holder for holder in holders if not _lives(holder)]
        is_tried_again = Shard.attempts < MAX_ATTEMPTS
        return release(session, Shard.holder.in_(dead), is_tried_again, values={"sent_at": None}) if dead else 0


def _lives(holder: str) -> bool:
    return Path(f"/proc/{holder.rpartition(':')[2]}").exists() or not Path("/proc/self").exists()


def watch_for_ever(context: Context, stopping: threading.Event) -> None:
    """Look every few seconds until told to stop."""
    while not stopping.wait(context.settings.reconcile_every_s):
        try:
            watch(context)
        except (SQLAlchemyError, OSError) as problem:
            log.warning("not watched", reason=reason_of(problem))


def start_watching(context: Context) -> threading.Event:
    """Watch in a thread of this process, with connections of its own; what is returned ends it."""
    stopping = threading.Event()
    own = make_context(context.settings)
    threading.Thread(target=watch_for_ever, args=(own, stopping), name="watch", daemon=True).start()
    return stopping
