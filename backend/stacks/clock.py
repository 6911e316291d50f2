"""When each frame was taken, and how warm it was then."""

from uuid import UUID

from pydantic import BaseModel
from sqlalchemy.orm import Session

from backend.models import Experiment
from backend.platform.object_store import ObjectStore
from backend.platform.visibility import Viewer
from backend.stacks import repository
from backend.stacks.errors import StackNotReady
from backend.stacks.schemas import Role
from backend.stacks.service import with_frame
from dropflow.errors import DropflowError
from dropflow.experiment import parse_experiment
from dropflow.ingest import StackIndex


class Clock(BaseModel):
    """One value a frame."""

    time_s: list[float]
    """Since the first frame."""
    temperature_c: list[float] | None
    """Where there is a temperature log that covers the film."""


def clock(session: Session, store: ObjectStore, viewer: Viewer, experiment_id: UUID) -> Clock:
    """Times as the description says them now, temperatures at these times."""
    experiment = with_frame(session, viewer, experiment_id, 0)
    if experiment.stack.index_key is None:
        raise StackNotReady
    index = StackIndex.model_validate_json(store.read(experiment.stack.index_key))
    timed = _timed(session, store, viewer, experiment, index)
    return Clock(
        time_s=list(timed.times_s),
        temperature_c=None if timed.temperatures_c is None else list(timed.temperatures_c),
    )


def _timed(
    session: Session, store: ObjectStore, viewer: Viewer, experiment: Experiment, index: StackIndex
) -> StackIndex:
    document = parse_experiment(experiment.document)
    logs = repository.places(session, viewer, experiment.id, Role.TEMPERATURE_LOG)
    place = logs.get(document.temperature_log or "")
    if place is None:
        return index.timed(document)
    try:
        with store.open_place(place) as log:
            return index.timed(document, log)
    except DropflowError:  # a corrected interval runs past the log: a run is told so; a picture still has its time
        return index.timed(document)
