"""Task import: bring frames from a folder of the server, or a prefix of S3, into an experiment, then have them read.

Files are copied some at a time into one object, as small files of an upload are, or stay where they are and are only
summed up. What is recorded stays: whoever takes the work up after a kill goes on with the next files.
"""

import hashlib
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from uuid import uuid4

from sqlalchemy import func, select, update

from backend.models import Experiment, File, Import, ImportMode, Shard
from backend.platform.database import after_commit
from backend.platform.events import announce, experiment_topic
from backend.platform.growing import Growing
from backend.platform.imported import outside_key
from backend.platform.object_store import ObjectStore, upload_key
from backend.platform.outside import Root
from backend.platform.places import INDEX_NAME, READ_BYTES, Piece, write_index
from backend.platform.wanted import Wanted, wanted_files
from dropflow.errors import FramesError
from worker.context import Context
from worker.leases import Claim, Lease, LeaseLost, held
from worker.outcomes import end_shard, lock_experiment
from worker.plan import Task

BUNDLE_BYTES, BUNDLE_FILES = 64_000_000, 1000
"""So much is recorded at once, and lost at most when the worker is killed (a file that is larger as a whole)."""
_TOLD_EVERY_S = 1.0


@dataclass(frozen=True)
class _Task:
    root_name: str
    root: Root
    mode: ImportMode
    files: Sequence[Wanted]


def work(context: Context, lease: Lease) -> None:
    """Bring what is not there yet, and put the reading of all frames on the list."""
    claim = lease.claim
    task, there = _load(context, claim)
    todo = [file for file in task.files if file.key not in there]
    report = _Report(context, lease, done_bytes=sum(file.found.size_bytes for file in task.files if file.key in there))
    for bundle in _bundles(todo):
        rows = _copied(context, claim, task, bundle, report) if task.mode is ImportMode.COPY else [
            _referred(claim, task, file, report) for file in bundle
        ]  # fmt: skip
        _record(context, claim, rows)
    _begin_ingest(context, claim)


def _load(context: Context, claim: Claim) -> tuple[_Task, set[tuple[str, str]]]:
    """What is to be brought, and which of it is there."""
    with context.sessions.begin() as session:
        asked = session.get(Import, claim.experiment_id)
        if asked is None:
            raise LeaseLost
        document = session.get_one(Experiment, claim.experiment_id).document
        found = select(File.role, File.name).where(File.experiment_id == claim.experiment_id)
        there = {(role, name) for role, name in session.execute(found)}
    root = _root(context.store, asked.root)
    return _Task(asked.root, root, asked.mode, wanted_files(root, asked.path, document)), there


def _root(store: ObjectStore, name: str) -> Root:
    try:
        return store.imported.root(name)
    except KeyError:
        raise FramesError(
            f"{name} is no longer on the list of what this service imports from.", code="frames.not_found"
        ) from None


def _bundles(files: Sequence[Wanted]) -> Iterator[list[Wanted]]:
    bundle: list[Wanted] = []
    n_bytes = 0
    for file in files:
        if bundle and (n_bytes + file.found.size_bytes > BUNDLE_BYTES or len(bundle) == BUNDLE_FILES):
            yield bundle
            bundle, n_bytes = [], 0
        bundle.append(file)
        n_bytes += file.found.size_bytes
    if bundle:
        yield bundle


def _copied(context: Context, claim: Claim, task: _Task, bundle: Sequence[Wanted], report: "_Report") -> list[File]:
    """Files one after the other in one new object."""
    key = upload_key(claim.experiment_id, uuid4(), can_grow=context.store.can_grow)
    growing = context.store.grow(key, at_byte=0, fence=claim.fence)
    rows, start_byte, pieces = [], 0, list[Piece]()
    try:
        for file in bundle:
            sha256 = _pour(task, file, growing, pieces, report)
            rows.append(_row(claim, file, sha256, key, start_byte=start_byte))
            start_byte += file.found.size_bytes
        pieces += growing.sync()
    finally:
        growing.close()
    if key.endswith("/"):
        context.store.put(key + INDEX_NAME, write_index(pieces))
    return rows


def _referred(claim: Claim, task: _Task, file: Wanted, report: "_Report") -> File:
    """A file that stays where it is: read once, for its checksum."""
    key = outside_key(task.root_name, file.path)
    return _row(claim, file, _pour(task, file, None, [], report), key, version=file.found.version)


def _pour(task: _Task, file: Wanted, growing: Growing | None, pieces: list[Piece], report: "_Report") -> str:
    """Read a file to its end, and write it where that is wanted. Returns its checksum."""
    digest, n_bytes, unsafe = hashlib.sha256(), 0, 0
    stream, now = task.root.open(file.path)
    with stream:
        while piece := stream.read(READ_BYTES):
            digest.update(piece)
            n_bytes += len(piece)
            if growing is not None:
                growing.write(piece)
                unsafe += len(piece)
                if unsafe >= growing.sync_bytes:
                    pieces += growing.sync()
                    unsafe = 0
            report(len(piece))
    again = task.root.look(file.path)
    if now.version != file.found.version or n_bytes != file.found.size_bytes or again != now:
        raise FramesError(
            "The file was changed while it was imported.",
            code="frames.changed",
            file=file.path,
            hint="Wait until it is written, then import again.",
        )
    return digest.hexdigest()


def _row(claim: Claim, file: Wanted, sha256: str, key: str, *, start_byte: int = 0, version: str | None = None) -> File:
    return File(
        id=uuid4(),
        experiment_id=claim.experiment_id,
        role=file.role,
        name=file.name,
        size_bytes=file.found.size_bytes,
        sha256=sha256,
        store_key=key,
        start_byte=start_byte,
        version=version,
    )


def _record(context: Context, claim: Claim, rows: Sequence[File]) -> None:
    """Make files count, if the work is still ours."""
    with context.sessions.begin() as session:
        lock_experiment(session, claim.experiment_id)
        if session.scalar(select(Shard.id).where(*held(claim)).with_for_update()) is None:
            raise LeaseLost
        session.add_all(rows)
        session.execute(update(Shard).where(*held(claim)).values(attempts=1))  # it gets somewhere
        announce(session, experiment_topic(claim.experiment_id))


def _begin_ingest(context: Context, claim: Claim) -> None:
    with context.sessions.begin() as session:
        experiment = lock_experiment(session, claim.experiment_id)
        end_shard(session, claim, "publish")
        asked = session.get_one(Import, claim.experiment_id)
        asked.finished_at, asked.done_bytes = func.now(), asked.size_bytes
        before = session.get_one(Shard, claim.shard_id)
        shard = Shard(experiment_id=experiment.id, person_id=before.person_id, task=Task.INGEST)
        session.add(shard)
        announce(session, experiment_topic(experiment.id))
        after_commit(session, lambda: context.queue.wake(Task.INGEST))


class _Report:
    """Tells how far it is, once a second, and hears whether it is still wanted."""

    def __init__(self, context: Context, lease: Lease, *, done_bytes: int) -> None:
        self._context, self._lease = context, lease
        self._done_bytes, self._before_bytes = done_bytes, done_bytes
        self._began_s = self._told_s = time.monotonic()

    def __call__(self, n_bytes: int) -> None:
        self._done_bytes += n_bytes
        if time.monotonic() - self._told_s > _TOLD_EVERY_S:
            self._told_s = time.monotonic()
            self._lease.renew()  # raises `LeaseLost` when somebody removed the stack meanwhile
            self._tell()

    def _tell(self) -> None:
        values: Mapping[str, float] = {
            "done_bytes": self._done_bytes,
            "bytes_per_s": (self._done_bytes - self._before_bytes) / (self._told_s - self._began_s),
        }
        with self._context.sessions.begin() as session:
            session.execute(
                update(Import).where(Import.experiment_id == self._lease.claim.experiment_id).values(values)
            )
            announce(session, experiment_topic(self._lease.claim.experiment_id))
