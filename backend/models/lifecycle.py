"""What one change brings with it for other rows: of a run's state, or that files go. Whoever calls holds the lock."""

from collections.abc import Iterable
from uuid import UUID

from sqlalchemy import ColumnElement, delete, exists, func, select, update
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from backend.models.base import Json
from backend.models.experiments import File
from backend.models.runs import DoomedObject, Product, Run, Shard, Stage
from backend.models.states import (
    OPEN_SHARD_STATES,
    RUN_RULES,
    SHARD_RULES,
    STAGE_RULES,
    RunState,
    ShardState,
    StageState,
    is_terminal,
    rule,
)
from backend.models.telling import tell_of_end

OUTSIDE = "outside:"
"""How the keys of files begin that stay where they were imported from."""


def end_run(session: Session, run: Run, event: str, *, problem: Json | None = None) -> None:
    """Complete, fail or cancel a run; what of it is not done yet will not be. A run that ended stays as it is."""
    found = rule(RUN_RULES, event)
    if run.state not in found.sources:
        return
    run.state = found.target
    run.problem = problem
    run.finished_at = func.now()
    cancel = rule(SHARD_RULES, "cancel")
    session.execute(
        update(Shard)
        .where(Shard.run_id == run.id, Shard.state.in_(cancel.sources))
        .values(state=cancel.target, lease_until=None, finished_at=func.now())
        .execution_options(synchronize_session=False)
    )
    end_open_stages(session, run, event)
    tell_of_end(session, run)


def end_open_stages(session: Session, run: Run, event: str) -> None:
    """The stage at work ends as its run does; those that never began are cancelled."""
    for stage in session.scalars(select(Stage).where(Stage.run_id == run.id)):
        if is_terminal(STAGE_RULES, stage.state):
            continue
        ending = event if stage.state == StageState.RUNNING else "cancel"
        stage.state = rule(STAGE_RULES, ending).target
        stage.finished_at = func.now()


def request_cancel(session: Session, run: Run) -> None:
    """Take back what waits; what a worker holds, it lets go when it next renews its lease."""
    run.cancel_requested_at = func.now()
    session.execute(
        update(Shard)
        .where(Shard.run_id == run.id, Shard.state == ShardState.QUEUED)
        .values(state=rule(SHARD_RULES, "cancel").target, finished_at=func.now())
        .execution_options(synchronize_session=False)
    )
    settle_cancel(session, run)


def settle_cancel(session: Session, run: Run) -> bool:
    """Cancel a run for which that was asked, once nobody works on it any more. The caller locks the experiment, too."""
    if run.cancel_requested_at is None or run.state not in (RunState.QUEUED, RunState.RUNNING):
        return False
    is_open = select(Shard.id).where(Shard.run_id == run.id, Shard.state.in_(OPEN_SHARD_STATES)).limit(1)
    if session.scalar(is_open) is not None:
        return False
    end_run(session, run, "cancel")
    free_space(session, run)
    return True


def free_space(session: Session, run: Run) -> None:
    """Remove what a run has made, unless another run shares it. The caller locks the experiment."""
    own = select(Shard.product_id).where(Shard.run_id == run.id)
    elsewhere = exists().where(Shard.product_id == Product.id, Shard.run_id != run.id)
    products = session.scalars(select(Product).where(Product.id.in_(own), ~elsewhere)).all()
    session.execute(
        update(Shard)
        .where(Shard.run_id == run.id, Shard.product_id.in_([product.id for product in products]))
        .values(product_id=None)
        .execution_options(synchronize_session=False)
    )
    doom(session, [product.prefix for product in products])
    for product in products:
        session.delete(product)


def doom(session: Session, keys: Iterable[str]) -> None:
    """Have objects removed, once this transaction is safe."""
    rows = [{"key": key} for key in keys]
    if rows:
        session.execute(insert(DoomedObject).values(rows).on_conflict_do_nothing())


def remove_files(session: Session, experiment_id: UUID, *conditions: ColumnElement[bool]) -> None:
    """Forget files of an experiment. Files that came together share their bytes, which go with the last of them."""
    gone = delete(File).where(File.experiment_id == experiment_id, *conditions).returning(File.store_key)
    keys = set(session.scalars(gone.execution_options(synchronize_session=False)))
    kept = select(File.store_key).where(File.experiment_id == experiment_id).distinct()
    gone_keys = keys - set(session.scalars(kept)) if keys else set()
    doom(session, sorted(key for key in gone_keys if not key.startswith(OUTSIDE)))  # those are not ours to remove
