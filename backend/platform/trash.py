"""The trash: what somebody deleted, still there and still taking room until the trash is emptied; then it is gone."""

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from backend.models import Experiment, File, Person, Product, Run, Shard, Stack
from backend.models.lifecycle import doom, free_space, remove_files
from backend.models.trashed import Trashed
from backend.platform.object_store import ObjectStore, experiment_prefix
from backend.platform.visibility import Viewer


def throw_away(session: Session, viewer: Viewer | None, thing: Trashed, n_bytes: int) -> None:
    """Put an experiment, a run or frames into the trash; the service itself does it where nobody is the viewer."""
    person = session.get(Person, viewer.person_id) if viewer is not None and viewer.person_id else None
    thing.trashed_at = func.now()
    thing.trashed_by = person.name if person else None
    thing.trashed_bytes = n_bytes


def bring_back(thing: Trashed) -> None:
    """Take out of the trash."""
    thing.trashed_at = thing.trashed_by = None
    thing.trashed_bytes = 0


def bytes_of_experiment(store: ObjectStore, experiment: Experiment) -> int:
    """All that is kept of it."""
    return sum(size for _, size in store.list(experiment_prefix(experiment.id)))


def bytes_of_run(session: Session, store: ObjectStore, run: Run) -> int:
    """What is kept of it alone: what another run shares stays when it goes."""
    own = select(Shard.product_id).where(Shard.run_id == run.id, Shard.product_id.is_not(None))
    shared = select(Shard.product_id).where(Shard.run_id != run.id, Shard.product_id.is_not(None))
    query = select(Product.prefix).where(Product.id.in_(own), Product.id.not_in(shared))
    prefixes = tuple(session.scalars(query))
    below = f"{experiment_prefix(run.experiment_id)}products/"
    return sum(size for key, size in store.list(below) if key.startswith(prefixes)) if prefixes else 0


def bytes_of_frames(session: Session, experiment: Experiment) -> int:
    """Its files, but for those that lie elsewhere."""
    query = select(func.coalesce(func.sum(File.size_bytes), 0))
    return int(session.scalar(query.where(File.experiment_id == experiment.id, File.version.is_(None))) or 0)


def remove_experiment(session: Session, experiment: Experiment) -> None:
    """For good. The caller holds its lock."""
    doom(session, [experiment_prefix(experiment.id)])
    session.delete(experiment)


def remove_run(session: Session, run: Run) -> None:
    """For good, with what it made unless another run shares it. The caller holds the locks of both."""
    free_space(session, run)
    session.execute(delete(Shard).where(Shard.run_id == run.id))
    session.flush()
    session.delete(run)


def remove_frames(session: Session, stack: Stack) -> None:
    """For good. What runs made of them stays."""
    remove_files(session, stack.experiment_id)
    bring_back(stack)
