"""Stage ingest: what a stack consists of, when each frame was taken, and checksums of all of it."""

import csv
import hashlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from dropflow.documents import StrictModel
from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import Experiment
from dropflow.frames import Choice, Files, Frames, open_frames, stack_files
from dropflow.progress import Progress, silent

_BLOCK_BYTES = 1 << 20


class StackFile(StrictModel):
    """One file of a stack."""

    name: str
    size_bytes: int
    sha256: str


class StackIndex(StrictModel):
    """All that later stages need to know of a stack without opening it."""

    n_frames: int
    n_rows: int
    n_columns: int
    dtype: str
    times_s: tuple[float, ...]
    """Time of each frame, seconds, strictly increasing."""
    files: tuple[StackFile, ...]
    """In the order of the frames."""
    attachments: tuple[StackFile, ...] = ()
    """What the experiment names beside the frames (flat field, times, temperatures); `name` is the field."""
    sha256: str
    """Of all names and checksums, attachments included: two stacks with the same value are the same."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of a frame."""
        return (self.n_rows, self.n_columns)


def index_stack(
    source: Path | Files,
    experiment: Experiment,
    *,
    attachments: Mapping[str, BinaryIO] | None = None,
    checksums: Mapping[str, str] | None = None,
    progress: Progress = silent,
) -> StackIndex:
    """Index a stack: order, number and size of its frames, their times, and a checksum of every file.

    Parameters
    ----------
    source
        As for `dropflow.frames.open_frames`.
    attachments
        The files that the experiment names, open for reading, by field: ``timestamps``, ``flat_field``, ...
    checksums
        SHA-256 of the frames' files by name where it is known already (as it is after an upload).
    progress
        Called as ``("ingest", files done, files)``.
    """
    attached = attachments or {}
    files, names = stack_files(source)
    with open_frames(source, Choice.of(experiment)) as frames:
        n_frames, (n_rows, n_columns), dtype = len(frames), frames.shape, str(frames.dtype)
    times_s = frame_times_s(experiment, n_frames, timestamps=attached.get("timestamps"))
    found = []
    for n_done, name in enumerate(names, start=1):
        with files.open(name) as file:
            found.append(_describe(name, file, (checksums or {}).get(name)))
        progress("ingest", n_done, len(names))
    beside = [_describe(field, file) for field, file in sorted(attached.items())]
    return StackIndex(
        n_frames=n_frames,
        n_rows=n_rows,
        n_columns=n_columns,
        dtype=dtype,
        times_s=tuple(times_s.tolist()),
        files=tuple(found),
        attachments=tuple(beside),
        sha256=_sha256_of_all([*found, *beside]),
    )


def check_frames(frames: Frames, progress: Progress = silent) -> None:
    """Decode every frame once, so that a broken one is known before hours of work begin.

    Raises
    ------
    FramesError
        Names the file and the frame.
    """
    for index in range(len(frames)):
        frames.read(index)
        progress("ingest", index + 1, len(frames))


def frame_times_s(
    experiment: Experiment, n_frames: int, *, timestamps: BinaryIO | None = None
) -> npt.NDArray[np.float64]:
    """Time of each frame in seconds, shape (n_frames,), strictly increasing: from the interval or from the CSV file."""
    if experiment.frame_interval_s is not None:
        return np.arange(n_frames, dtype=np.float64) * experiment.frame_interval_s
    name = str(experiment.timestamps)
    if timestamps is None:
        raise _timestamps_error(f"the file {name} is missing")
    timestamps.seek(0)
    times_s = _read_times_s(timestamps, name)
    if len(times_s) != n_frames:
        raise _timestamps_error(f"{name} holds {len(times_s)} times for {n_frames} frames")
    backwards = np.flatnonzero(~(np.diff(times_s) > 0))
    if backwards.size:
        raise _timestamps_error(f"time does not increase from frame {backwards[0]} to {backwards[0] + 1} in {name}")
    return times_s


def _read_times_s(file: BinaryIO, name: str) -> npt.NDArray[np.float64]:
    try:
        text = io.StringIO(file.read().decode("utf-8-sig"), newline="")
        rows = csv.DictReader(text)
        if "time_s" not in (rows.fieldnames or ()):
            raise _timestamps_error(f"{name} has no column time_s")
        times = [float(row["time_s"]) for row in rows]
    except (UnicodeDecodeError, csv.Error, TypeError, ValueError) as problem:
        if isinstance(problem, ExperimentError):
            raise
        raise _timestamps_error(f"{name} is not a CSV file with a number time_s in each row ({problem})") from None
    if not np.isfinite(times).all():
        raise _timestamps_error(f"{name} holds a time that is not a finite number")
    return np.array(times, np.float64)


def _timestamps_error(message: str) -> ExperimentError:
    return ExperimentError("Please correct:", fields=[FieldProblem("timestamps", message)])


def _describe(name: str, file: BinaryIO, known_sha256: str | None = None) -> StackFile:
    size_bytes = file.seek(0, 2)
    return StackFile(name=name, size_bytes=size_bytes, sha256=known_sha256 or _sha256(file))


def _sha256(file: BinaryIO) -> str:
    digest = hashlib.sha256()
    file.seek(0)
    while block := file.read(_BLOCK_BYTES):
        digest.update(block)
    return digest.hexdigest()


def _sha256_of_all(files: list[StackFile]) -> str:
    return hashlib.sha256("".join(f"{file.sha256}  {file.name}\n" for file in files).encode()).hexdigest()
