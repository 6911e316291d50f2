"""How much of the disk and of the workers a group uses, and what it may use."""

from collections.abc import Mapping, Sequence
from uuid import UUID

from sqlalchemy import BigInteger, ColumnElement, Select, cast, func, select, true
from sqlalchemy.orm import Session

from backend.groups.errors import QuotaExceeded, TooManyRuns
from backend.groups.schemas import Usage
from backend.models import Experiment, File, Group, Product, Run, Upload
from backend.models.states import ACTIVE_RUN_STATES
from backend.platform.settings import Settings


def usages(session: Session, settings: Settings, groups: Sequence[Group]) -> Mapping[UUID, Usage]:
    """What each group uses, and may use."""
    ids = [group.id for group in groups]
    theirs = Experiment.group_id.in_(ids)
    uploaded = dict(session.execute(_file_bytes(theirs)).all())
    made = dict(session.execute(_product_bytes(theirs)).all())
    coming = dict(session.execute(_coming_bytes(theirs)).all())
    active = dict(session.execute(_active_runs(ids)).all())
    return {
        group.id: Usage(
            used_bytes=sum(int(part.get(group.id, 0)) for part in (uploaded, made, coming)),
            max_bytes=settings.group_max_bytes if group.max_bytes is None else group.max_bytes,
            n_active_runs=active.get(group.id, 0),
            max_active_runs=settings.group_max_active_runs if group.max_active_runs is None else group.max_active_runs,
        )
        for group in groups
    }


def demand_room(session: Session, settings: Settings, group: Group, n_bytes: int) -> None:
    """Refuse what would not fit, before any of it comes; what else was announced counts as if it were there."""
    _lock(session, group)
    usage = usages(session, settings, [group])[group.id]
    if usage.max_bytes is not None and usage.used_bytes + n_bytes > usage.max_bytes:
        raise QuotaExceeded(usage.used_bytes, usage.max_bytes)


def bytes_of(session: Session, experiment_id: UUID) -> int:
    """What one experiment uses: its frames, what is to come of them, and what its runs made."""
    parts = (_file_bytes, _coming_bytes, _product_bytes)
    return sum(int(n or 0) for part in parts for _, n in session.execute(part(Experiment.id == experiment_id)))


def demand_run(session: Session, settings: Settings, group: Group) -> None:
    """Refuse one run more than the group may have at once; two that start at once are counted one after the other."""
    _lock(session, group)
    usage = usages(session, settings, [group])[group.id]
    if usage.max_active_runs is not None and usage.n_active_runs >= usage.max_active_runs:
        raise TooManyRuns(usage.max_active_runs)


def _lock(session: Session, group: Group) -> None:
    """Whoever else wants something of this group waits until this transaction ends."""
    session.execute(select(Group.id).where(Group.id == group.id).with_for_update(key_share=True))


def _coming_bytes(which: ColumnElement[bool]) -> Select[UUID, int]:
    return (
        select(Experiment.group_id, func.sum(Upload.size_bytes))
        .join(Upload, Upload.experiment_id == Experiment.id)
        .where(which, Upload.finished_at.is_(None), Upload.problem.is_(None))
        .where(Upload.expires_at > func.now())
        .group_by(Experiment.group_id)
    )


def _file_bytes(which: ColumnElement[bool]) -> Select[UUID, int]:
    return (
        select(Experiment.group_id, func.sum(File.size_bytes))
        .join(File, File.experiment_id == Experiment.id)
        .where(which, File.version.is_(None))  # what lies elsewhere takes no room here
        .group_by(Experiment.group_id)
    )


def _product_bytes(which: ColumnElement[bool]) -> Select[UUID, int]:
    file = func.jsonb_array_elements(Product.files).table_valued("value").render_derived()
    size_bytes = cast(func.jsonb_extract_path_text(file.c.value, "size_bytes"), BigInteger)
    return (
        select(Experiment.group_id, func.sum(size_bytes))
        .join(Product, Product.experiment_id == Experiment.id)
        .join(file, onclause=true())
        .where(which)
        .group_by(Experiment.group_id)
    )


def _active_runs(group_ids: Sequence[UUID]) -> Select[UUID, int]:
    return (
        select(Experiment.group_id, func.count())
        .join(Run, Run.experiment_id == Experiment.id)
        .where(Experiment.group_id.in_(group_ids), Run.state.in_(ACTIVE_RUN_STATES))
        .group_by(Experiment.group_id)
    )
