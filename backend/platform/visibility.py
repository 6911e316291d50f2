"""Who may see and do what, decided in one place and in the query: what is not visible is as if it were not there."""

from dataclasses import dataclass, replace
from datetime import datetime
from http import HTTPStatus
from uuid import UUID

from sqlalchemy import ColumnElement, Select, func, or_, select
from sqlalchemy.orm import InstrumentedAttribute

from backend.models import Experiment, Group, Membership, Person, Right, Run, ShareLink
from backend.models.people import at_least
from backend.platform.problems import ServiceError


@dataclass(frozen=True)
class Viewer:
    """Whoever asks, and the right that their request needs: the queries below find nothing where they lack it."""

    person_id: UUID | None
    needs: Right = Right.VIEW
    share_id: UUID | None = None
    """The link by which somebody without an account looks at one run."""
    is_administrator: bool = False
    """Governs people and groups; what belongs to groups they see as members only, as everybody does."""

    def only_looking(self) -> "Viewer":
        """The same person, who asks only to see."""
        return replace(self, needs=Right.VIEW)


LOCAL_VIEWER = Viewer(person_id=UUID("00000000-0000-4000-8000-000000000001"))
"""The one person of a service that only its own machine can reach."""


class MayNot(ServiceError):
    """They see it, and may not do that with it."""

    default_code = "forbidden"
    status = HTTPStatus.FORBIDDEN

    def __init__(self, needed: Right) -> None:
        super().__init__(
            f"This needs the right to {needed.value} in its group.",
            code=f"forbidden.{needed.value}",
            hint="Ask somebody who manages the group.",
        )


def visible_groups(viewer: Viewer) -> Select[Group]:
    """The groups in which this person has the right that they need."""
    return select(Group).where(Group.id.in_(_group_ids(viewer)))


def governed_groups(viewer: Viewer) -> Select[Group]:
    """The same, and for an administrator every group that is not somebody's personal space."""
    seen: ColumnElement[bool] = Group.id.in_(_group_ids(viewer))
    if viewer.is_administrator:
        seen = or_(seen, Group.personal_of.is_(None))
    return select(Group).where(seen)


def visible_experiments(viewer: Viewer, *, in_trash: bool | None = False) -> Select[Experiment]:
    """Experiments of these groups, and the one of a shared run; those in the trash only if asked for (None: too)."""
    seen: ColumnElement[bool] = Experiment.group_id.in_(_group_ids(viewer))
    if _is_sharing(viewer):
        seen = or_(seen, Experiment.id.in_(select(Run.experiment_id).where(Run.id.in_(_shared_run_ids(viewer)))))
    return select(Experiment).where(seen, *_where(Experiment.trashed_at, in_trash))


def visible_runs(viewer: Viewer, *, in_trash: bool | None = False) -> Select[Run]:
    """Runs of the experiments of these groups, and a shared run; those in the trash only if asked for (None: too)."""
    experiments = select(Experiment.id).where(Experiment.group_id.in_(_group_ids(viewer)))
    seen: ColumnElement[bool] = Run.experiment_id.in_(experiments)
    if _is_sharing(viewer):
        seen = or_(seen, Run.id.in_(_shared_run_ids(viewer)))
    is_there = Run.experiment.has(Experiment.trashed_at.is_(None))  # with its experiment, a run is in the trash
    return select(Run).where(seen, *_where(Run.trashed_at, in_trash), *(() if in_trash is None else (is_there,)))


def _where(
    trashed_at: InstrumentedAttribute[datetime | None], in_trash: bool | None
) -> tuple[ColumnElement[bool], ...]:
    if in_trash is None:
        return ()
    return (trashed_at.is_not(None) if in_trash else trashed_at.is_(None),)


def _group_ids(viewer: Viewer) -> Select[UUID]:
    return (
        select(Membership.group_id)
        .join(Person, Person.id == Membership.person_id)
        .where(
            Membership.person_id == viewer.person_id,
            Membership.right.in_(at_least(viewer.needs)),
            Person.disabled_at.is_(None),
        )
    )


def _is_sharing(viewer: Viewer) -> bool:
    return viewer.share_id is not None and viewer.needs is Right.VIEW


def _shared_run_ids(viewer: Viewer) -> Select[UUID]:
    return select(ShareLink.run_id).where(ShareLink.id == viewer.share_id, ShareLink.expires_at > func.now())
