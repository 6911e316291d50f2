"""How a shard ends, each in one transaction: published, failed, given back, let go.

Whoever ends a shard of a run holds the lock on the run's row meanwhile, so exactly one finds that it was the last
and begins what follows. Messages go out after the commit.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any
from uuid import UUID

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from backend.models import Experiment, FrameSummary, Product, Run, Shard, Stack
from backend.models.lifecycle import doom, settle_cancel
from backend.models.states import SHARD_RULES, rule
from backend.platform.events import announce, experiment_topic, run_topic
from backend.platform.object_store import product_prefix
from worker.context import Context
from worker.fan_in import NewShard, advance, insert_shards, start_stage
from worker.leases import Claim, LeaseLost, held, release
from worker.plan import Task

_UNCOUNTED = {"attempts": func.greatest(Shard.attempts - 1, 0)}
"""Whoever gives a shard back says so: only those who fall silent use up its tries."""
KEPT_S = 1800.0
"""So long a shard that gave way waits for the machine where its state is; then any may begin it anew."""


@dataclass(frozen=True)
class NewProduct:
    """What a shard made: objects below `prefix`, and what of it goes into the database."""

    prefix: str
    files: list[dict[str, Any]] = field(default_factory=list)
    sizes: bytes | None = None
    """Packed `FrameHistograms`."""
    flow: bytes | None = None
    """Packed `FlowMoments`."""
    summary: dict[str, Any] | None = None
    film_key: str | None = None
    """What it has in common with other ranges of the same film."""


def begin(context: Context, claim: Claim) -> None:
    """A worker has a shard: its run and stage are running, if they were not yet."""
    if claim.run_id is None:
        return
    with context.sessions.begin() as session:
        run = lock_run(session, claim.run_id)
        start_stage(session, run, Task(claim.task))
        _announce(session, run)


def publish(context: Context, claim: Claim, product: NewProduct, follow: Sequence[NewShard] = ()) -> None:
    """Record what a shard made, and begin what follows it. Raises `LeaseLost` if the shard is not ours any more."""
    assert claim.run_id is not None  # noqa: S101 - the ingest has its own end
    with context.sessions.begin() as session:
        lock_experiment(session, claim.experiment_id)  # so that what is reused is not removed meanwhile
        run = lock_run(session, claim.run_id)
        row = Product(
            experiment_id=claim.experiment_id,
            task=claim.task,
            input_key=claim.input_key or str(claim.shard_id),
            film_key=product.film_key,
            start_frame=claim.start_frame,
            stop_frame=claim.stop_frame,
            prefix=product.prefix,
            files=product.files,
            summary=product.summary,
        )
        session.add(row)
        session.flush()
        if product.sizes is not None:
            session.add(FrameSummary(product_id=row.id, sizes=product.sizes, flow=product.flow))
        n_frames = claim.stop_frame - claim.start_frame
        end_shard(session, claim, "publish", product_id=row.id, done_frames=n_frames)
        if run.cancel_requested_at is not None:
            settle_cancel(session, run)
        else:
            insert_shards(session, context, run, follow)
            advance(session, context, run, Task(claim.task))
        _announce(session, run)


def let_go(context: Context, claim: Claim) -> None:
    """The run was cancelled: the shard is, too, and the last one to let go ends the run."""
    assert claim.run_id is not None  # noqa: S101 - only runs are cancelled
    with context.sessions.begin() as session:
        lock_experiment(session, claim.experiment_id)
        run = lock_run(session, claim.run_id)
        end_shard(session, claim, "cancel")
        settle_cancel(session, run)
        _announce(session, run)


def give_back(context: Context, claim: Claim) -> None:
    """Something that the work needs was away: somebody goes on, when the reconciler next asks."""
    with context.sessions.begin() as session:
        release(session, *held(claim), values=_UNCOUNTED | {"sent_at": None})


def give_way(context: Context, claim: Claim) -> None:
    """Somebody else waits: the shard goes to the end of the row, and stays with the machine that has its state."""
    kept_until = func.clock_timestamp() + timedelta(seconds=KEPT_S)
    with context.sessions.begin() as session:
        release(
            session,
            *held(claim),
            values=_UNCOUNTED
            | {
                "sent_at": None,
                "done_frames": Shard.done_frames,
                "started_at": func.clock_timestamp(),  # its person was served until now
                "kept_on": context.machine,
                "kept_until": kept_until,
            },
        )
    context.queue.wake(claim.task)


def give_back_after_error(context: Context, claim: Claim) -> None:
    """The work met an error that may pass: somebody tries again after a pause."""
    with context.sessions.begin() as session:
        release(session, *held(claim), values=_UNCOUNTED | {"sent_at": func.now(), "n_errors": Shard.n_errors + 1})


def give_back_all(context: Context, holders: str) -> int:
    """A worker stops: what its processes hold goes back, and the broken-off try does not count. Returns how many."""
    with context.sessions.begin() as session:
        return release(session, Shard.holder.like(holders), values=_UNCOUNTED | {"sent_at": None})


def is_published(context: Context, prefix: str) -> bool:
    """Whether a row speaks of the objects below `prefix`."""
    with context.sessions.begin() as session:
        product = select(Product.id).where(Product.prefix == prefix)
        index = select(Stack.experiment_id).where(Stack.index_key.startswith(prefix, autoescape=True))
        return session.scalar(product) is not None or session.scalar(index) is not None


def end_shard(session: Session, claim: Claim, event: str, **values: Any) -> None:
    """One update under the fence; raises `LeaseLost` where it changes nothing."""
    found = rule(SHARD_RULES, event)
    ended = session.execute(
        update(Shard)
        .where(*held(claim))
        .values({"state": found.target, "lease_until": None, "finished_at": func.now(), **values})
        .returning(Shard.id)
    )
    if ended.one_or_none() is None:
        raise LeaseLost
    # Those who held it before may have been killed while they wrote.
    doom(session, [product_prefix(claim.experiment_id, claim.shard_id, fence) for fence in range(1, claim.fence)])


def lock_run(session: Session, run_id: UUID) -> Run:
    """The owner of a shard, which nobody else changes until this transaction ends."""
    query = select(Run).where(Run.id == run_id).with_for_update(of=Run, key_share=True)
    run = session.scalar(query.execution_options(populate_existing=True))
    if run is None:
        raise LeaseLost  # it was deleted
    return run


def lock_experiment(session: Session, experiment_id: UUID) -> Experiment:
    """The owner of an ingest, which nobody else changes until this transaction ends."""
    query = select(Experiment).where(Experiment.id == experiment_id).with_for_update(of=Experiment, key_share=True)
    experiment = session.scalar(query.execution_options(populate_existing=True))
    if experiment is None:
        raise LeaseLost
    return experiment


def _announce(session: Session, run: Run) -> None:
    announce(session, run_topic(run.id), experiment_topic(run.experiment_id))
