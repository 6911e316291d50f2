"""Who may see what, decided in one place and in the query: what is not visible is as if it were not there."""

from dataclasses import dataclass
from uuid import UUID

from sqlalchemy import Select, select

from backend.models import Experiment, Group, Membership, Run


@dataclass(frozen=True)
class Viewer:
    """Whoever asks."""

    person_id: UUID


LOCAL_VIEWER = Viewer(person_id=UUID("00000000-0000-4000-8000-000000000001"))
"""The one person of a service that only its own machine can reach."""


def visible_groups(viewer: Viewer) -> Select[Group]:
    """The groups this person is a member of."""
    return select(Group).join(Membership).where(Membership.person_id == viewer.person_id)


def visible_experiments(viewer: Viewer) -> Select[Experiment]:
    """Experiments of the groups this person is a member of."""
    groups = select(Membership.group_id).where(Membership.person_id == viewer.person_id)
    return select(Experiment).where(Experiment.group_id.in_(groups))


def visible_runs(viewer: Viewer) -> Select[Run]:
    """Runs of the experiments this person may see."""
    experiments = visible_experiments(viewer).with_only_columns(Experiment.id)
    return select(Run).where(Run.experiment_id.in_(experiments))
