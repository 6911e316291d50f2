"""Exports, each made by a process of its own while it is being sent: the service answers others meanwhile."""

import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import structlog

from backend.models import Product
from backend.platform.object_store import ObjectStore
from backend.results.errors import ExportsBusy
from dropflow.exports.kinds import SUFFIX, Kind

MOST_AT_ONCE = 2
_READ_BYTES = 1 << 20
_POLL_S = 0.1
_ABANDONED_S = 86_400.0
_FOLDER = "export_"
_TABLES = ("droplets.parquet", "trajectories.parquet", "flow.zarr")
_SUMMARY = "summary.json"
_SEEKING = frozenset({Kind.HDF5, Kind.NETCDF})
"""Kinds whose first bytes are written last: they are sent when they are complete."""

_free = threading.BoundedSemaphore(MOST_AT_ONCE)
log = structlog.get_logger()


def file_name(kind: Kind, run_number: int) -> str:
    """What an export is called."""
    return f"run-{run_number}-{kind}{SUFFIX[kind]}"


def export(store: ObjectStore, tracked: Product, analysed: Product, kind: Kind, work_dir: Path) -> Iterator[bytes]:
    """The bytes of an export, as they are made.

    Raises
    ------
    ExportsBusy
        Others are being made.
    """
    if not _free.acquire(blocking=False):
        raise ExportsBusy
    try:
        work_dir.mkdir(parents=True, exist_ok=True)
        _remove_abandoned(work_dir)
        folder = Path(tempfile.mkdtemp(prefix=_FOLDER, dir=work_dir))
    except BaseException:
        _free.release()
        raise
    return _made(store, tracked, analysed, kind, folder)


def _made(store: ObjectStore, tracked: Product, analysed: Product, kind: Kind, folder: Path) -> Iterator[bytes]:
    process: subprocess.Popen[bytes] | None = None
    try:
        results = _results(store, tracked, analysed, folder)
        output = folder / f"export{SUFFIX[kind]}"
        words = ["export", str(results), "--kind", kind, "--output", str(output)]
        code = "import sys; from dropflow.cli import main; sys.argv[0] = 'dropflow'; main()"
        process = subprocess.Popen(
            [sys.executable, "-c", code, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        if kind in _SEEKING:
            process.wait()
        yield from _grown(process, output)
        if process.wait():
            said = process.stderr.read().decode(errors="replace")[-2000:] if process.stderr else ""
            log.error("export failed", kind=kind, reason=said)
            # The answer has begun: to break it off is the only way left to say that it is not complete.
            raise RuntimeError(f"the export ended with code {process.returncode}")
    finally:
        if process is not None:
            process.kill()
            process.wait()
            if process.stderr:
                process.stderr.close()
        shutil.rmtree(folder, ignore_errors=True)
        _free.release()


def _grown(process: subprocess.Popen[bytes], output: Path) -> Iterator[bytes]:
    """The bytes of a file while a process writes it; it has its final name once it is complete."""
    unfinished = output.with_name(output.name + ".part")
    while not output.exists() and not unfinished.exists():
        if process.poll() is not None and not output.exists():
            return
        time.sleep(_POLL_S)
    with (output if output.exists() else unfinished).open("rb") as file:
        while True:
            has_ended = process.poll() is not None
            while piece := file.read(_READ_BYTES):
                yield piece
            if has_ended:
                return
            time.sleep(_POLL_S)


def _results(store: ObjectStore, tracked: Product, analysed: Product, folder: Path) -> Path:
    """A folder as `dropflow analyse` leaves it, of links where the objects are files already."""
    results = folder / "results"
    results.mkdir()
    tables = store.as_folder(tracked.prefix, folder / "tables")
    for name in _TABLES:
        (results / name).symlink_to(tables / name)
    (results / _SUMMARY).write_bytes(store.read(analysed.prefix + _SUMMARY))
    return results


def _remove_abandoned(work_dir: Path) -> None:
    """What a process that was killed has left."""
    for path in work_dir.glob(f"{_FOLDER}*"):
        if time.time() - path.stat().st_mtime > _ABANDONED_S:
            shutil.rmtree(path, ignore_errors=True)
