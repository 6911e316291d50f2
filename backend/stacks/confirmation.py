"""That a person has looked at the frames and says that order, times and scale are right: who, when, and of what."""

from uuid import UUID

from sqlalchemy import func
from sqlalchemy.orm import Session

from backend.experiments.service import get_locked
from backend.models import Experiment, Person
from backend.models.states import StackState
from backend.platform.audit import tell
from backend.platform.confirmed import facts_of
from backend.platform.events import announce, experiment_topic
from backend.platform.visibility import Viewer
from backend.stacks.errors import OtherFacts, StackNotReady
from backend.stacks.schemas import Confirm


def confirm(session: Session, viewer: Viewer, experiment_id: UUID, said: Confirm) -> Experiment:
    """Record it, if what the person saw is what is here."""
    experiment = get_locked(session, viewer, experiment_id)
    stack = experiment.stack
    if stack.state != StackState.READY:
        raise StackNotReady
    if said.model_dump() != (facts := facts_of(experiment)):
        raise OtherFacts
    person = session.get(Person, viewer.person_id) if viewer.person_id else None
    stack.confirmation = {"by": person.name if person else "", "facts": facts}
    stack.confirmed_at = func.now()
    tell(session, experiment_id=experiment.id, **{name: str(value) for name, value in facts.items()})
    announce(session, experiment_topic(experiment.id))
    session.flush()
    session.refresh(stack)
    return experiment
