"""Whom the end of a run is told: the webhooks of its group that ask for it, and who started it."""

from collections.abc import Iterator

from sqlalchemy import select
from sqlalchemy.orm import Session

from backend.models.base import Json
from backend.models.experiments import Experiment
from backend.models.notices import Event, Notice, Webhook
from backend.models.people import Group, Membership, Person
from backend.models.runs import Run

_MAILED = (Event.RUN_COMPLETED, Event.RUN_FAILED)
"""Whoever cancels a run knows."""


def tell_of_end(session: Session, run: Run) -> None:
    """Write down who is to be told that a run ended, in the transaction that ends it."""
    experiment = session.get_one(Experiment, run.experiment_id)
    event = Event(f"run.{run.state}")
    about = _about(run, experiment, session.get_one(Group, experiment.group_id))
    session.add_all(
        Notice(event=event, run_id=run.id, about=about, **receiver)
        for receiver in (*_webhooks(session, experiment, event), *_mailboxes(session, run, experiment, event))
    )


def _about(run: Run, experiment: Experiment, group: Group) -> Json:
    return {
        "run": {"id": str(run.id), "number": run.number, "state": run.state, "problem": run.problem},
        "experiment": {"id": str(experiment.id), "name": experiment.document["name"]},
        "group": {"id": str(group.id), "name": group.name},
    }


def _webhooks(session: Session, experiment: Experiment, event: Event) -> Iterator[Json]:
    asking = select(Webhook.id).where(
        Webhook.group_id == experiment.group_id, Webhook.is_active, Webhook.events.contains([event])
    )
    for webhook_id in session.scalars(asking):
        yield {"webhook_id": webhook_id}


def _mailboxes(session: Session, run: Run, experiment: Experiment, event: Event) -> Iterator[Json]:
    """Who started it, if they want that and may still see it."""
    if event not in _MAILED:
        return
    may_see = select(Membership.person_id).where(Membership.group_id == experiment.group_id)
    wanting = select(Person.id).where(
        Person.id == run.person_id,
        Person.id.in_(may_see),
        Person.is_mailed,
        Person.email.is_not(None),
        Person.disabled_at.is_(None),
    )
    for person_id in session.scalars(wanting):
        yield {"person_id": person_id}
