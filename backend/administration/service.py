"""The service as a whole, for those who look after it. What belongs to groups is named here, and not shown."""

from collections import Counter
from collections.abc import Sequence
from datetime import timedelta

from sqlalchemy.orm import Session

from backend.administration import repository, schemas
from backend.models import Run
from backend.models.states import ShardState
from backend.platform.object_store import ObjectStore
from backend.platform.problems import Problem
from backend.platform.queue import QUEUE_OF_TASK, QUEUES

LATELY = timedelta(days=7)
LONG = timedelta(hours=6)


def overview(session: Session, store: ObjectStore) -> schemas.Overview:
    """Queues, workers, disk, and the work that went wrong or goes on for long."""
    holders = repository.holders(session)
    return schemas.Overview(
        queues=_queues(session),
        workers=[
            schemas.Holder(name=name, n_shards=n, oldest_started_at=started_at) for name, n, started_at in holders
        ],
        disk=schemas.Disk(
            free_bytes=store.free_bytes(),
            frames_bytes=repository.frames_bytes(session),
            results_bytes=repository.results_bytes(session),
        ),
        failed=_troubles(repository.failed(session, LATELY)),
        slow=_troubles(repository.slow(session, LONG)),
    )


def audit(session: Session, query: schemas.AuditQuery) -> schemas.AuditLog:
    """One page of the audit log."""
    found, next_cursor = repository.audit(session, query)
    items = [schemas.AuditLine.model_validate(line) for line in found]
    return schemas.AuditLog(items=items, next_cursor=next_cursor)


def _queues(session: Session) -> list[schemas.QueueLength]:
    n_shards: Counter[tuple[str, ShardState]] = Counter()
    for task, state, n in repository.shards_by_state(session):
        n_shards[QUEUE_OF_TASK.get(task, task), state] += n
    return [
        schemas.QueueLength(
            name=queue, n_waiting=n_shards[queue, ShardState.QUEUED], n_running=n_shards[queue, ShardState.RUNNING]
        )
        for queue in QUEUES
    ]


def _troubles(runs: Sequence[Run]) -> list[schemas.Trouble]:
    return [
        schemas.Trouble(
            run_id=run.id,
            experiment_name=run.document["name"],
            group_name=run.experiment.group.name,
            number=run.number,
            state=run.state,
            started_at=run.started_at,
            finished_at=run.finished_at,
            problem=Problem.model_validate(run.problem) if run.problem else None,
        )
        for run in runs
    ]
