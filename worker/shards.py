"""Looking at a shard: claim it, do it, and end it one way or another."""

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from uuid import UUID

import structlog
from sqlalchemy import ScalarSelect
from sqlalchemy.exc import OperationalError

from backend.platform.object_store import product_prefix
from backend.platform.problems import problem_of
from backend.platform.queue import QUEUE_OF_TASK
from backend.platform.reasons import reason_of
from backend.platform.tracing import span, went_wrong
from dropflow.errors import Cancelled, DropflowError
from dropflow.ingest import BrokenFramesError
from worker import analyse, detect, imports, ingest, outcomes, prepare, track
from worker.context import Context
from worker.failures import cause_of, fail
from worker.giving_way import GaveWay
from worker.heartbeat import at_work
from worker.leases import MAX_ERRORS, Claim, Lease, LeaseLost, claim
from worker.outcomes import is_published
from worker.plan import Task
from worker.turns import whose_turn
from worker.work_folders import sweep

WORK: Mapping[Task, Callable[[Context, Lease], None]] = {
    Task.IMPORT: imports.work,
    Task.INGEST: ingest.work,
    Task.PREPARE: prepare.work,
    Task.DETECT: detect.work,
    Task.TRACK: track.work,
    Task.ANALYSE: analyse.work,
}
log = structlog.get_logger()


def look_in(context: Context, queue: str) -> None:
    """Do the shard whose turn it is in a queue, if there is one."""
    tasks = [Task(task) for task, its_queue in QUEUE_OF_TASK.items() if its_queue == queue]
    look_at(context, whose_turn(tasks, context.machine))


def look_at(context: Context, which: UUID | ScalarSelect[UUID]) -> None:
    """Do a shard if it is to be done. Asked twice, or too late, this changes nothing."""
    with context.sessions.begin() as session:
        taken = claim(session, which, holder=context.holder, lease_s=context.settings.lease_s)
    if taken is None:
        return
    with structlog.contextvars.bound_contextvars(**_named(taken)), span(f"shard {taken.task}", _named(taken)):
        began_s = time.monotonic()
        try:
            _do(context, taken)
            log.info("shard left", took_s=round(time.monotonic() - began_s, 3))
        except LeaseLost as lost:
            went_wrong(lost)
            log.info("lease lost")
            _remove_output(context, taken)
            sweep(context)


def _named(taken: Claim) -> dict[str, str | int]:
    """What is worked on, as logs and traces name it."""
    run = {"run": str(taken.run_id)} if taken.run_id else {}
    shard = {"experiment": str(taken.experiment_id), "shard": str(taken.shard_id), "task": taken.task}
    return {**run, **shard, "fence": taken.fence, "start_frame": taken.start_frame, "stop_frame": taken.stop_frame}


def _do(context: Context, taken: Claim) -> None:
    outcomes.begin(context, taken)
    try:
        with at_work(context.settings.work_dir) as beat:
            lease = Lease(context.sessions, taken, lease_s=context.settings.lease_s, beat=beat)
            with lease.kept(context.settings.longest_step_s):
                WORK[Task(taken.task)](context, lease)
    except LeaseLost:
        raise
    except GaveWay:
        log.info("gave way")
        outcomes.give_way(context, taken)
    except Cancelled:
        _remove_output(context, taken)
        outcomes.let_go(context, taken)
    except DropflowError as error:
        went_wrong(error)
        log.info("shard failed", code=error.code, reason=str(error))
        _remove_output(context, taken)
        keeps_files = isinstance(error, BrokenFramesError) and not error.is_most
        fail(context, taken, problem_of(error), keeps_files=keeps_files)
    except OperationalError as problem:
        went_wrong(problem)
        log.warning("broken off", reason=reason_of(problem))
        _remove_output(context, taken)
        with suppress(OperationalError):  # the database is still away: the lease will run out
            outcomes.give_back(context, taken)
    except Exception as error:
        went_wrong(error)
        log.exception("unexpected error", n_errors=taken.n_errors + 1)
        _remove_output(context, taken)
        if taken.n_errors + 1 < MAX_ERRORS:
            outcomes.give_back_after_error(context, taken)
        else:
            fail(context, taken, cause_of(error, taken))


def _remove_output(context: Context, taken: Claim) -> None:
    """What was written under this fence is of no use, unless it was published and only the answer got lost."""
    prefix = product_prefix(taken.experiment_id, taken.shard_id, taken.fence)
    try:
        if not is_published(context, prefix):
            context.store.remove(prefix)
    except Exception:
        log.exception("output not removed", prefix=prefix)
