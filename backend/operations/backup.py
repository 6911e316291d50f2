"""`dropflow-server backup FOLDER`: the database as it is at one moment, every object, and the configuration.

Objects never change once they are written, so a second backup into the same folder copies only what is new. While it
runs nothing is removed from the object store (the reconciler waits), so that all the rows speak of is there.
"""

import json
import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import Engine, text

from backend.operations.errors import OperationError
from backend.operations.tables import revision_of, table_names, write_table
from backend.platform.holding import KEEP_OBJECTS
from backend.platform.object_store import ObjectStore
from backend.platform.places import READ_BYTES
from dropflow.provenance import code_version

Report = Callable[[str], None]
MANIFEST = "manifest.json"
MOMENTS, OBJECTS, CONFIGURATION = "moments", "objects", "configuration"
FORM = 1
"""Of the folder; a later one is refused by an earlier version."""


def back_up(
    engine: Engine,
    store: ObjectStore,
    folder: Path,
    *,
    configuration: Sequence[Path] = (),
    n_kept: int = 7,
    report: Report,
) -> Path:
    """Write a backup into `folder` and return the folder of its moment; older ones beyond `n_kept` are dropped.

    Raises
    ------
    OperationError
        The database has no tables, or a file of the configuration is not there.
    """
    missing = [str(path) for path in configuration if not path.exists()]
    if missing:
        raise OperationError(f"Not found: {', '.join(missing)}. Name the files of your configuration.")
    moments = folder / MOMENTS
    (folder / OBJECTS).mkdir(parents=True, exist_ok=True)
    moments.mkdir(mode=0o700, exist_ok=True)
    _sweep_unfinished(moments)
    name = f"{datetime.now(UTC):%Y%m%dT%H%M%S.%fZ}"
    unfinished = moments / f".{name}-{os.getpid()}"
    unfinished.mkdir(mode=0o700)
    with _objects_held(engine):
        manifest = _write_database(engine, unfinished, report)
        manifest["objects"] = _write_objects(store, folder / OBJECTS, unfinished / "objects.tsv", report)
    _write_configuration(configuration, unfinished / CONFIGURATION)
    _write_durably(unfinished / MANIFEST, json.dumps(manifest, indent=2))
    finished = unfinished.rename(moments / name)
    _drop_old(folder, n_kept, report)
    return finished


def moments_of(folder: Path) -> list[Path]:
    """Finished backups in a folder, oldest first."""
    found = (folder / MOMENTS).glob("[0-9]*")
    return sorted(path for path in found if (path / MANIFEST).is_file())


@contextmanager
def _objects_held(engine: Engine) -> Iterator[None]:
    """Keep the reconciler from removing objects meanwhile; a killed backup lets go by itself."""
    with engine.connect() as connection:
        connection.execute(text("SELECT pg_advisory_lock_shared(:key)"), {"key": KEEP_OBJECTS})
        connection.commit()
        try:
            yield
        finally:
            connection.execute(text("SELECT pg_advisory_unlock_shared(:key)"), {"key": KEEP_OBJECTS})


def _write_database(engine: Engine, folder: Path, report: Report) -> dict[str, object]:
    target = folder / "database"
    target.mkdir()
    with engine.connect().execution_options(isolation_level="REPEATABLE READ") as connection:
        revision = revision_of(connection)
        if revision is None:
            raise OperationError("The database has no tables yet: there is nothing to keep.")
        tables = {}
        for name in table_names(connection):
            n_rows, sha256 = write_table(connection, name, target / f"{name}.copy")
            tables[name] = {"rows": n_rows, "sha256": sha256}
    n_rows = sum(int(str(table["rows"])) for table in tables.values())
    report(f"database: {len(tables)} tables, {n_rows:,} rows")
    return {
        "form": FORM,
        "version": code_version(),
        "revision": revision,
        "made_at": datetime.now(UTC).isoformat(timespec="seconds"),
        "tables": tables,
    }


def _write_objects(store: ObjectStore, folder: Path, listing: Path, report: Report) -> dict[str, int]:
    """Copy what is new; `listing` says which objects (size, key) belong to this moment."""
    n_bytes = n_copied = n_objects = 0
    objects = store.list("")
    with listing.open("w", encoding="utf-8") as out:
        for number, (key, listed_size) in enumerate(objects, 1):
            target = folder / key
            if not target.is_file() or target.stat().st_size != listed_size:
                try:
                    _copy(store, key, target)
                except FileNotFoundError:
                    continue  # a part of an upload that ended meanwhile; no row of this moment speaks of it
                n_copied += 1
            # What an upload is still writing has grown since it was listed.
            size = target.stat().st_size
            out.write(f"{size}\t{key}\n")
            n_bytes, n_objects = n_bytes + size, n_objects + 1
            if number % 1000 == 0:
                report(f"objects: {number:,} of {len(objects):,}")
    report(f"objects: {n_objects:,} ({n_bytes / 1e9:.3g} GB), {n_copied:,} of them new")
    return {"count": n_objects, "bytes": n_bytes, "copied": n_copied}


def _copy(store: ObjectStore, key: str, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(f"{target.name}.partial")
    with store.open(key) as source, partial.open("wb") as out:
        shutil.copyfileobj(source, out, READ_BYTES)
        out.flush()
        os.fsync(out.fileno())
    partial.rename(target)


def _write_configuration(paths: Sequence[Path], folder: Path) -> None:
    folder.mkdir(mode=0o700)
    for path in paths:
        target = folder / path.name
        if path.is_dir():
            shutil.copytree(path, target)
        else:
            shutil.copy2(path, target)


def _sweep_unfinished(moments: Path) -> None:
    for left in moments.glob(".*"):
        shutil.rmtree(left)


def _drop_old(folder: Path, n_kept: int, report: Report) -> None:
    moments = moments_of(folder)
    kept = moments[-n_kept:]
    for old in moments[: len(moments) - len(kept)]:
        shutil.rmtree(old)
    if len(kept) == len(moments):
        return
    wanted = {key for moment in kept for _, key in listed(moment)}
    root = folder / OBJECTS
    unwanted = [path for path in root.rglob("*") if path.is_file() and path.relative_to(root).as_posix() not in wanted]
    for path in unwanted:
        path.unlink()
    report(f"dropped {len(moments) - len(kept)} older backups and {len(unwanted):,} objects that only they had")


def listed(moment: Path) -> Iterator[tuple[int, str]]:
    """Size and key of each object of a backup."""
    with (moment / "objects.tsv").open(encoding="utf-8") as lines:
        for line in lines:
            size, key = line.rstrip("\n").split("\t", 1)
            yield int(size), key


def _write_durably(file: Path, content: str) -> None:
    with file.open("w", encoding="utf-8") as out:
        out.write(content)
        out.flush()
        os.fsync(out.fileno())
