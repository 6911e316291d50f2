"""`python -m worker.reconcile`: every few seconds, put right what messages and workers lost.

Any number may run; an advisory lock lets one work at a time. Nothing is remembered between rounds: each looks at the
database, so it does not matter when the last one was, or who did it.
"""

import signal
import threading
from datetime import timedelta
from uuid import UUID

import structlog
from obstore.exceptions import BaseError
from redis.exceptions import RedisError
from sqlalchemy import ColumnElement, and_, func, or_, select, text, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from backend.models import DoomedObject, Run, Shard
from backend.models.lifecycle import end_run, settle_cancel
from backend.models.states import SHARD_RULES, ShardState, rule
from backend.platform.events import announce, experiment_topic, run_topic
from backend.platform.holding import KEEP_OBJECTS
from backend.platform.logging import set_up_logging
from backend.platform.queue import QUEUE_OF_TASK, QUEUES
from backend.platform.reasons import reason_of
from backend.platform.settings import environment_settings
from backend.platform.tallies import tally
from worker.context import Context, make_context
from worker.failures import reject_stack, worker_lost
from worker.leases import MAX_ATTEMPTS, LeaseLost, is_expired, release
from worker.notices import Teller, forget_old
from worker.outcomes import lock_experiment, lock_run
from worker.storage import Sweeper, expire_uploads

_MOST_AT_ONCE = 500
log = structlog.get_logger()


def reconcile(context: Context) -> None:
    """One round. A part that fails (the broker is away, say) keeps none of the others from its work."""
    with context.sessions.begin() as lock:
        if not lock.scalar(text("SELECT pg_try_advisory_xact_lock(hashtext('dropflow.reconcile'))")):
            return
        for part in (expire_leases, send_again, expire_uploads, remove_doomed, forget_old):
            try:
                part(context)
            except (SQLAlchemyError, RedisError, OSError) as problem:
                log.warning("not reconciled", part=part.__name__, reason=reason_of(problem))


def expire_leases(context: Context) -> None:
    """Shards whose holder is silent go to another; after too many tries their run fails with the cause."""
    silent = select(Shard.id, Shard.run_id, Shard.experiment_id).where(Shard.state == ShardState.RUNNING, is_expired())
    with context.sessions.begin() as session:
        found = session.execute(silent).all()
    for shard_id, run_id, experiment_id in found:
        try:
            with context.sessions.begin() as session:
                if run_id is None:
                    _expire_ingest(session, shard_id, experiment_id)
                else:
                    lock_experiment(session, experiment_id)
                    _expire_shard(session, shard_id, lock_run(session, run_id))
                tally(session, "lease_expiries")
        except LeaseLost:
            continue  # it was deleted in between


def _expire_shard(session: Session, shard_id: UUID, run: Run) -> None:
    shard = _still_silent(session, shard_id)
    if shard is None:
        return
    if run.cancel_requested_at is not None:
        shard.state = rule(SHARD_RULES, "cancel").target
        session.flush()
        settle_cancel(session, run)
    elif shard.attempts >= MAX_ATTEMPTS:
        shard.state = rule(SHARD_RULES, "fail").target
        problem = worker_lost(shard.start_frame, shard.stop_frame - 1, shard.task)
        end_run(session, run, "fail", problem=problem.model_dump())
    else:
        _return(session, shard)
    announce(session, run_topic(run.id), experiment_topic(run.experiment_id))


def _expire_ingest(session: Session, shard_id: UUID, experiment_id: UUID) -> None:
    experiment = lock_experiment(session, experiment_id)
    shard = _still_silent(session, shard_id)
    if shard is None:
        return
    if shard.attempts >= MAX_ATTEMPTS:
        shard.state = rule(SHARD_RULES, "fail").target
        reject_stack(session, experiment, worker_lost(0, 0, f"the {shard.task} of the frames"))
    else:
        _return(session, shard)


def _still_silent(session: Session, shard_id: UUID) -> Shard | None:
    query = select(Shard).where(Shard.id == shard_id, Shard.state == ShardState.RUNNING, is_expired())
    return session.scalar(query.with_for_update(key_share=True))


def _return(session: Session, shard: Shard) -> None:
    log.warning(
        "lease expired",
        run=str(shard.run_id) if shard.run_id else None,
        shard=str(shard.id),
        task=shard.task,
        holder=shard.holder,
        attempt=shard.attempts,
    )
    release(session, Shard.id == shard.id, values={"sent_at": None})


def send_again(context: Context) -> None:
    """Shards that nobody was told of, or whose message was lost: an empty queue cannot hold it."""
    for queue in QUEUES:
        if context.queue.n_waiting(queue):
            continue
        tasks = [task for task, its_queue in QUEUE_OF_TASK.items() if its_queue == queue]
        with context.sessions.begin() as session:
            waiting = (
                select(Shard.id)
                .where(
                    Shard.state == ShardState.QUEUED,
                    Shard.task.in_(tasks),
                    _is_overdue(context.settings.resend_after_s),
                )
                .order_by(Shard.created_at, Shard.start_frame)
                .limit(_MOST_AT_ONCE)
            )
            sent = session.execute(
                update(Shard)
                .where(Shard.id.in_(waiting), Shard.state == ShardState.QUEUED)
                .values(sent_at=func.clock_timestamp())
                .returning(Shard.task)
            ).all()
        for (task,) in sent:
            context.queue.wake(task)


def _is_overdue(resend_after_s: float) -> ColumnElement[bool]:
    """Given back just now (nobody was told yet), or told of some time ago."""
    latest = func.clock_timestamp() - timedelta(seconds=resend_after_s)
    never_told = and_(Shard.sent_at.is_(None), or_(Shard.attempts > 0, Shard.fence > 0, Shard.created_at < latest))
    return or_(never_told, Shard.sent_at < latest)


def remove_doomed(context: Context) -> None:
    """Bytes whose last row is gone."""
    with context.sessions.begin() as session:
        if not session.scalar(text("SELECT pg_try_advisory_xact_lock(:key)"), {"key": KEEP_OBJECTS}):
            return  # a backup copies them just now
        query = select(DoomedObject).order_by(DoomedObject.created_at).limit(_MOST_AT_ONCE)
        for doomed in session.scalars(query.with_for_update(skip_locked=True)):
            context.store.remove(doomed.key)
            session.delete(doomed)


def main() -> None:
    """Reconcile until told to stop."""
    settings = environment_settings()
    set_up_logging(settings.log_level)
    stopping = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopping.set())
    context = make_context(settings)
    sweeper, teller = Sweeper(), Teller(settings)
    teller.start()
    while not stopping.is_set():
        try:
            reconcile(context)
            sweeper(context)
        except (SQLAlchemyError, OSError, BaseError) as problem:
            log.warning("database or store away", reason=reason_of(problem))
        stopping.wait(settings.reconcile_every_s)
    teller.stop()
    context.close()


if __name__ == "__main__":
    main()
