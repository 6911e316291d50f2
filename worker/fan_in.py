"""What follows when a shard is published: the last one of a task begins the next. The caller holds the run's lock."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from backend.models import Product, Run, Shard, Stage
from backend.models.lifecycle import end_run
from backend.models.states import RUN_RULES, STAGE_RULES, RunState, ShardState, rule
from backend.platform.database import after_commit
from dropflow.experiment import parse_experiment
from dropflow.parameters import parse_parameters
from worker.context import Context
from worker.keys import film_key
from worker.plan import NEXT_TASK, STAGE_OF_TASK, Task


@dataclass(frozen=True)
class NewShard:
    """A piece of work to be done, unless there is a product under its key already."""

    task: Task
    frames: range
    input_key: str


def start_stage(session: Session, run: Run, task: Task) -> None:
    """Somebody works on a stage of a run: both are running, if they were not yet."""
    run_rule, stage_rule = rule(RUN_RULES, "start"), rule(STAGE_RULES, "start")
    stage = session.get_one(Stage, (run.id, STAGE_OF_TASK[task]))
    if run.state in run_rule.sources and stage.state in stage_rule.sources:
        run.state, stage.state = run_rule.target, stage_rule.target
        run.started_at = run.started_at or func.now()
        stage.started_at = stage.started_at or func.now()


def insert_shards(session: Session, context: Context, run: Run, shards: Sequence[NewShard]) -> None:
    """Put work on the list; what an earlier run has made under the same key is done already."""
    keys = [shard.input_key for shard in shards]
    made = session.execute(
        select(Product.input_key, Product.id).where(
            Product.experiment_id == run.experiment_id, Product.input_key.in_(keys)
        )
    )
    known: dict[str, UUID] = dict(made.all())
    rows = [_row(run, shard, known.get(shard.input_key)) for shard in shards]
    session.add_all(rows)
    session.flush()
    for row in rows:
        if row.state == ShardState.QUEUED:
            after_commit(session, _sender(context, row))


def advance(session: Session, context: Context, run: Run, task: Task) -> None:
    """Begin what follows `task` if that was its last shard; complete the run after the last task of all."""
    following: Task | None = task
    while following is not None and run.state == RunState.RUNNING and _is_done(session, run, following):
        task, following = following, NEXT_TASK[following]
        _end_stage(session, run, task)
        if following not in (None, Task.DETECT):
            insert_shards(session, context, run, [_film_shard(session, run, task, following)])
        if following is None:
            _complete(session, run, task)


def _row(run: Run, shard: NewShard, product_id: UUID | None) -> Shard:
    row = Shard(
        experiment_id=run.experiment_id,
        run_id=run.id,
        person_id=run.person_id,
        task=shard.task,
        start_frame=shard.frames.start,
        stop_frame=shard.frames.stop,
        input_key=shard.input_key,
    )
    if product_id is not None:
        row.state, row.product_id, row.is_reused = ShardState.COMPLETED, product_id, True
        row.done_frames = len(shard.frames)
    return row


def _complete(session: Session, run: Run, last: Task) -> None:
    made = select(Product.summary).join(Shard, Shard.product_id == Product.id)
    run.summary = session.scalar(made.where(Shard.run_id == run.id, Shard.task == last))
    end_run(session, run, "complete")


def _is_done(session: Session, run: Run, task: Task) -> bool:
    shards = select(Shard.id).where(Shard.run_id == run.id, Shard.task == task).limit(1)
    is_left = session.scalar(shards.where(Shard.state != ShardState.COMPLETED))
    return is_left is None and session.scalar(shards) is not None


def _film_shard(session: Session, run: Run, task: Task, following: Task) -> NewShard:
    """The one shard of a task that needs the whole film, addressed by all that the task before was addressed by."""
    query = select(Shard.input_key).where(Shard.run_id == run.id, Shard.task == task).order_by(Shard.start_frame)
    inputs = [str(key) for key in session.scalars(query)]
    key = film_key(following, inputs, parse_experiment(run.document), parse_parameters(run.parameters))
    n_frames = run.stages[0].total_frames
    return NewShard(following, range(n_frames), key)


def _end_stage(session: Session, run: Run, task: Task) -> None:
    if task is Task.PREPARE:
        return
    stage = session.get_one(Stage, (run.id, STAGE_OF_TASK[task]))
    found = rule(STAGE_RULES, "complete")
    if stage.state in found.sources:
        stage.state = found.target
        stage.started_at = stage.started_at or func.now()
        stage.finished_at = func.now()


def _sender(context: Context, shard: Shard) -> Callable[[], None]:
    return lambda: context.queue.wake(shard.task)
