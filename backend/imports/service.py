"""Frames that are on the server already, or in a store that it can read: looked at, and brought in by a worker."""

from collections.abc import Iterator
from contextlib import contextmanager
from uuid import UUID

from sqlalchemy import delete
from sqlalchemy.orm import Session

from backend.experiments.service import get, get_locked
from backend.groups.quotas import demand_room
from backend.imports import schemas
from backend.imports.errors import FramesThere, NoSuchRoot, RootAway
from backend.models import Experiment, Import, ImportMode, Shard
from backend.models.states import STACK_RULES, StackState, rule
from backend.platform.audit import tell
from backend.platform.database import after_commit
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic
from backend.platform.outside import Root
from backend.platform.store_errors import StoreFull
from backend.platform.visibility import Viewer
from backend.platform.wanted import wanted_files
from backend.stacks import repository as stacks
from backend.stacks.attachments import disagreements
from backend.stacks.errors import StackClosed, TooLarge
from backend.stacks.schemas import Role
from dropflow.errors import ExperimentError

_SHOWN_FILES = 200


def look(
    session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, root: str | None, path: str
) -> schemas.Place:
    """What frames of this experiment could be imported from."""
    experiment = get(session, viewer, experiment_id)
    roots = _roots(platform, experiment)
    if root is None:
        return schemas.Place(roots=roots, root=None, path="", folders=[], files=[], n_files=0, size_bytes=0)
    with _reached():
        found = _root(platform, experiment, root).listing(path)
    files = [schemas.OutsideFile(name=file.name, size_bytes=file.size_bytes) for file in found.files[:_SHOWN_FILES]]
    return schemas.Place(
        roots=roots,
        root=root,
        path=path.removesuffix("/"),
        folders=list(found.folders),
        files=files,
        n_files=len(found.files),
        size_bytes=sum(file.size_bytes for file in found.files),
    )


def create(
    session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, new: schemas.NewImport
) -> Experiment:
    """Have a worker bring frames in, and then read them all. What cannot be is refused before it begins."""
    experiment = get_locked(session, viewer, experiment_id)
    _check_free(session, viewer, experiment, new)
    with _reached():
        wanted = wanted_files(_root(platform, experiment, new.root), new.path, experiment.document)
    there = [(file.role, file.name) for file in stacks.files(session, viewer, experiment_id)]
    files = [file for file in wanted if file.key not in there]
    if problems := disagreements(experiment.document, [*there, *(file.key for file in files)]):
        raise ExperimentError("The experiment and the files there do not agree.", fields=problems)
    size_bytes, new_bytes = (sum(file.found.size_bytes for file in some) for some in (wanted, files))
    if size_bytes > platform.settings.max_stack_bytes:
        raise TooLarge("stack", platform.settings.max_stack_bytes, new.path)
    if new.mode is ImportMode.COPY:
        _check_room(session, platform, experiment, new_bytes)
    session.execute(delete(Import).where(Import.experiment_id == experiment.id))
    session.add(
        Import(
            experiment_id=experiment.id,
            root=new.root,
            path=new.path,
            mode=new.mode,
            n_files=len(wanted),
            size_bytes=size_bytes,
        )
    )
    shard = Shard(experiment_id=experiment.id, person_id=viewer.person_id, task="import")
    session.add(shard)
    experiment.stack.state = rule(STACK_RULES, "import").target
    experiment.stack.problem = None
    announce(session, experiment_topic(experiment.id))
    tell(session, experiment_id=experiment.id, root=new.root, path=new.path, mode=new.mode.value)
    session.flush()
    after_commit(session, lambda: platform.queue.wake("import"))
    return experiment


def _check_free(session: Session, viewer: Viewer, experiment: Experiment, new: schemas.NewImport) -> None:
    """Nothing is there yet, or a part of the very same import, which then goes on."""
    if experiment.stack.state in (StackState.INDEXING, StackState.READY):
        raise StackClosed
    has_frames = any(file.role == Role.FRAMES for file in stacks.files(session, viewer, experiment.id))
    begun = session.get(Import, experiment.id)
    if begun is not None and begun.finished_at is None:
        has_frames &= (begun.root, begun.path, begun.mode) != (new.root, new.path, new.mode)
    if has_frames or stacks.missing(session, experiment.id)[0]:
        raise FramesThere


def _check_room(session: Session, platform: Platform, experiment: Experiment, n_bytes: int) -> None:
    demand_room(session, platform.settings, experiment.group, n_bytes)
    free_bytes = platform.store.free_bytes()
    if free_bytes is not None and n_bytes > free_bytes:
        raise StoreFull(f"The storage has {free_bytes:,} bytes left, and the files there are {n_bytes:,} bytes.")


def _roots(platform: Platform, experiment: Experiment) -> list[str]:
    """Those of the list that are for the group of the experiment."""
    listed = platform.settings.import_roots.items()
    return [name for name, root in listed if root.groups is None or experiment.group.name in root.groups]


def _root(platform: Platform, experiment: Experiment, name: str) -> Root:
    if name not in _roots(platform, experiment):
        raise NoSuchRoot
    return platform.store.imported.root(name)


@contextmanager
def _reached() -> Iterator[None]:
    try:
        yield
    except OSError:
        raise RootAway from None
