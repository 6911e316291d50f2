"""Queries about the service as a whole."""

from collections.abc import Sequence
from datetime import timedelta

from sqlalchemy import BigInteger, Select, cast, func, select, true
from sqlalchemy.orm import Session, contains_eager

from backend.administration.schemas import AuditQuery
from backend.models import AuditEntry, Experiment, File, Product, Run, Shard
from backend.models.states import RunState, ShardState
from backend.platform.pages import Order, page_of

_MOST = 20


def shards_by_state(session: Session) -> Sequence[tuple[str, ShardState, int]]:
    """Task, state and number of the pieces of work that are not done."""
    query = select(Shard.task, Shard.state, func.count()).where(
        Shard.state.in_((ShardState.QUEUED, ShardState.RUNNING))
    )
    return [(task, state, n) for task, state, n in session.execute(query.group_by(Shard.task, Shard.state))]


def holders(session: Session) -> Sequence[tuple[str, int, object]]:
    """Who holds work, how much, and since when."""
    query = select(Shard.holder, func.count(), func.min(Shard.started_at)).where(Shard.state == ShardState.RUNNING)
    found = session.execute(query.group_by(Shard.holder).order_by(Shard.holder))
    return [(holder or "?", n, started_at) for holder, n, started_at in found]


def frames_bytes(session: Session) -> int:
    """Bytes of all uploaded files."""
    return int(session.scalar(select(func.coalesce(func.sum(File.size_bytes), 0))) or 0)


def results_bytes(session: Session) -> int:
    """Bytes of all results that people can fetch."""
    file = func.jsonb_array_elements(Product.files).table_valued("value").render_derived()
    size_bytes = cast(func.jsonb_extract_path_text(file.c.value, "size_bytes"), BigInteger)
    query = select(func.coalesce(func.sum(size_bytes), 0)).select_from(Product).join(file, onclause=true())
    return int(session.scalar(query) or 0)


def failed(session: Session, since: timedelta) -> Sequence[Run]:
    """Runs that failed lately, latest first."""
    query = _runs().where(Run.state == RunState.FAILED, Run.finished_at > func.now() - since)
    return session.scalars(query.order_by(Run.finished_at.desc()).limit(_MOST)).all()


def slow(session: Session, longer_than: timedelta) -> Sequence[Run]:
    """Runs that go on for long, longest first."""
    query = _runs().where(Run.state == RunState.RUNNING, Run.started_at < func.now() - longer_than)
    return session.scalars(query.order_by(Run.started_at).limit(_MOST)).all()


def _runs() -> Select[Run]:
    return select(Run).join(Run.experiment).options(contains_eager(Run.experiment)).join(Experiment.group)


def audit(session: Session, query: AuditQuery) -> tuple[Sequence[AuditEntry], str | None]:
    """One page of the audit log, newest first."""
    asked = select(AuditEntry)
    if query.person_id is not None:
        asked = asked.where(AuditEntry.person_id == query.person_id)
    if query.action is not None:
        asked = asked.where(AuditEntry.action == query.action)
    order = Order("-id", (AuditEntry.id.expression,), is_descending=True)
    return page_of(session, asked, order, limit=query.limit, cursor=query.cursor)
