"""Folders in which work stands until it is in the object store.

A later holder of a shard on the same machine takes over the folder of the one before, checkpoints and all, by renaming
it: should that one be still alive, it finds nothing under the name it knows, and can spoil nothing.
"""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import UUID

from sqlalchemy import select

from backend.models import Shard
from backend.models.states import OPEN_SHARD_STATES
from dropflow.errors import DropflowError
from worker.context import Context
from worker.leases import Claim


@contextmanager
def work_folder(root: Path, claim: Claim) -> Iterator[Path]:
    """The folder of one claim. It goes when the work is done or not wanted; when it breaks off, it stays."""
    root.mkdir(parents=True, exist_ok=True)
    folder = root / f"{claim.shard_id}-{claim.fence}"
    earlier = _earlier_folders(root, claim)
    if earlier:
        earlier[-1].replace(folder)
    folder.mkdir(exist_ok=True)
    for abandoned in earlier[:-1]:
        shutil.rmtree(abandoned, ignore_errors=True)
    try:
        yield folder
    except DropflowError:  # it cannot be done, or is not wanted: nobody will go on with it
        shutil.rmtree(folder, ignore_errors=True)
        raise
    shutil.rmtree(folder, ignore_errors=True)


def sweep(context: Context) -> None:
    """Remove the folders of shards that nobody will go on with, such as those of runs that were deleted."""
    folders = {folder: _shard_of(folder) for folder in context.settings.work_dir.glob("*-*")}
    ids = [shard_id for shard_id in folders.values() if shard_id is not None]
    with context.sessions.begin() as session:
        wanted = set(session.scalars(select(Shard.id).where(Shard.id.in_(ids), Shard.state.in_(OPEN_SHARD_STATES))))
    for folder, shard_id in folders.items():
        if shard_id not in wanted:
            shutil.rmtree(folder, ignore_errors=True)


def _earlier_folders(root: Path, claim: Claim) -> list[Path]:
    """Of the same shard, in the order of their fences."""
    found = [(int(path.name.rpartition("-")[2]), path) for path in root.glob(f"{claim.shard_id}-*")]
    return [path for fence, path in sorted(found) if fence < claim.fence]


def _shard_of(folder: Path) -> UUID | None:
    try:
        return UUID(folder.name.rpartition("-")[0])
    except ValueError:
        return None
