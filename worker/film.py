"""What a shard needs to know of its film: the experiment as the run knows it, its files, and what was prepared."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from backend.models import File, Product, Run, Shard, Stack
from backend.platform.object_store import ObjectStore
from backend.platform.places import Place
from backend.platform.store_files import PLACED, StoreFiles, place_of
from dropflow.experiment import Experiment, parse_experiment
from dropflow.frames import Choice, Frames, open_frames
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters, parse_parameters
from dropflow.preprocess import StackEstimate
from dropflow.preprocess.estimate import ESTIMATE_FILE
from worker.context import Context
from worker.leases import Claim, LeaseLost
from worker.plan import Task

INDEX_FILE = "index.json"
FRAMES_ROLE = "frames"


@dataclass(frozen=True)
class Film:
    """A film and how it is to be analysed."""

    run_id: UUID
    experiment: Experiment
    parameters: Parameters
    files: dict[str, dict[str, Place]]
    """Where each uploaded file is kept, by name, by role."""
    store: ObjectStore
    left_out: tuple[int, ...]
    """Frames that cannot be read."""

    @contextmanager
    def frames(self) -> Iterator[Frames]:
        """The stack, open."""
        source = StoreFiles(self.store, self.files[FRAMES_ROLE])
        with open_frames(source, Choice.of(self.experiment, self.left_out)) as frames:
            yield frames


@dataclass(frozen=True)
class PreparedFilm(Film):
    """A film of which all is known that every shard shares."""

    index: StackIndex
    measured: StackEstimate


def load_film(context: Context, claim: Claim) -> tuple[Film, StackIndex]:
    """The film of a claim's run, and the index as the upload left it."""
    with context.sessions.begin() as session:
        run = _run(session, claim)
        files = uploaded_files(session, claim.experiment_id)
        index_key = session.scalar(select(Stack.index_key).where(Stack.experiment_id == claim.experiment_id))
    if index_key is None:
        raise LeaseLost
    index = StackIndex.model_validate_json(context.store.read(index_key))
    experiment, parameters = parse_experiment(run.document), parse_parameters(run.parameters)
    return Film(run.id, experiment, parameters, files, context.store, index.broken_frames), index


def load_prepared(context: Context, claim: Claim) -> PreparedFilm:
    """The film of a claim's run with what its first shard prepared."""
    with context.sessions.begin() as session:
        run = _run(session, claim)
        files = uploaded_files(session, claim.experiment_id)
        prefix = prefixes(session, run.id, Task.PREPARE)[0]
    index = StackIndex.model_validate_json(context.store.read(prefix + INDEX_FILE))
    return PreparedFilm(
        run.id,
        parse_experiment(run.document),
        parse_parameters(run.parameters),
        files,
        context.store,
        index.broken_frames,
        index,
        StackEstimate.load(io.BytesIO(context.store.read(prefix + ESTIMATE_FILE))),
    )


def prefixes(session: Session, run_id: UUID, task: Task) -> list[str]:
    """Where the products of a task of a run are, in the order of their frames."""
    query = (
        select(Product.prefix)
        .join(Shard, Shard.product_id == Product.id)
        .where(Shard.run_id == run_id, Shard.task == task)
        .order_by(Shard.start_frame)
    )
    return list(session.scalars(query))


def made_ranges(session: Session, experiment_id: UUID, detection: str) -> list[range]:
    """The frames whose droplets earlier runs have found in the very same way."""
    query = select(Product.start_frame, Product.stop_frame).where(
        Product.experiment_id == experiment_id, Product.film_key == detection
    )
    return [range(*found) for found in session.execute(query).all()]


def uploaded_files(session: Session, experiment_id: UUID) -> dict[str, dict[str, Place]]:
    """Where each uploaded file is kept, by name, by role."""
    found: dict[str, dict[str, Place]] = {FRAMES_ROLE: {}}
    for row in session.execute(select(File.role, File.name, *PLACED).where(File.experiment_id == experiment_id)):
        found.setdefault(row.role, {})[row.name] = place_of(row)
    return found


def _run(session: Session, claim: Claim) -> Run:
    run = session.get(Run, claim.run_id)
    if run is None:
        raise LeaseLost
    return run
