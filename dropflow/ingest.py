"""Stage ingest: what a stack consists of, when each frame was taken, what is odd about it, and checksums of all."""

import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from dropflow.documents import StrictModel
from dropflow.errors import FramesError
from dropflow.experiment import Experiment
from dropflow.frame_times import differing_times, frame_times_s
from dropflow.frames import Choice, Files, Finding, Frame, Frames, open_frames, stack_files
from dropflow.frames.findings import finding
from dropflow.frames.numbering import Gap, Numbering, numbering
from dropflow.physics.temperature_log import parse_temperature_log
from dropflow.progress import Progress, silent

_BLOCK_BYTES = 1 << 20


class StackFile(StrictModel):
    """One file of a stack."""

    name: str
    size_bytes: int
    sha256: str


class FrameCheck(StrictModel):
    """What reading every frame once has shown."""

    warnings: tuple[Finding, ...] = ()
    broken_frames: tuple[int, ...] = ()
    """Frames that cannot be read."""


class BrokenFramesError(FramesError):
    """Some frames cannot be read, and more than may be missing."""

    is_most: bool = False
    """That of most frames: then these are other files than was meant."""


class StackIndex(StrictModel):
    """All that later stages need to know of a stack without opening it."""

    n_frames: int
    """Those that can be read."""
    n_rows: int
    n_columns: int
    dtype: str
    times_s: tuple[float, ...]
    """Time of each frame, seconds, strictly increasing."""
    temperatures_c: tuple[float, ...] | None = None
    """Temperature at each of these times, from the experiment's temperature log."""
    gaps: tuple[Gap, ...] = ()
    """Frames whose numbers are missing between the files' names."""
    warnings: tuple[Finding, ...] = ()
    """What is odd but no error."""
    broken_frames: tuple[int, ...] = ()
    """Frames that cannot be read and are left out, counted as in the files (as `gaps` are); all else counts without."""
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

    def checked(self, check: FrameCheck) -> "StackIndex":
        """The same with what reading every frame has shown, without the frames that are broken: gaps in time."""
        kept = np.delete(np.arange(self.n_frames), check.broken_frames)
        temperatures_c = self.temperatures_c
        return self.model_copy(
            update={
                "warnings": self.warnings + check.warnings,
                "broken_frames": check.broken_frames,
                "n_frames": len(kept),
                "times_s": tuple(self.times_s[index] for index in kept),
                "temperatures_c": temperatures_c and tuple(temperatures_c[index] for index in kept),
            }
        )

    def timed(self, experiment: Experiment, temperature_log: BinaryIO | None = None) -> "StackIndex":
        """The same with the times of an experiment whose frame interval was corrected, and its temperatures then.

        Other times stay as they were. `temperature_log` is the file that the experiment names.
        """
        if experiment.frame_interval_s is None:
            return self
        n_in_files = self.n_frames + len(self.broken_frames)
        times_s = np.delete(frame_times_s(experiment, n_in_files, gaps=self.gaps), self.broken_frames)
        temperatures_c = _temperatures_c(temperature_log, times_s)
        return self.model_copy(update={"times_s": tuple(times_s.tolist()), "temperatures_c": temperatures_c})


def missing_warning(index: StackIndex) -> list[dict[str, str]]:
    """What results say of frames that could not be read."""
    broken = index.broken_frames
    if not broken:
        return []
    n_in_files = index.n_frames + len(broken)
    which = ", ".join([*map(str, broken[:5]), *(["..."] if len(broken) > 5 else [])])
    message = (
        f"{len(broken)} of {n_in_files} frames ({100 * len(broken) / n_in_files:.2g} %) could not be read and are left "
        f"out, as gaps in time (counted in the files from 0: {which}). Frames are counted without them."
    )
    return [{"code": "frames.missing", "message": message}]


def index_stack(
    source: Path | Files,
    experiment: Experiment,
    *,
    attachments: Mapping[str, BinaryIO] | None = None,
    known: Mapping[str, StackFile] | None = None,
    progress: Progress = silent,
) -> StackIndex:
    """Index a stack: order, number and size of its frames, their times and gaps, and a checksum of every file.

    Parameters
    ----------
    source
        As for `dropflow.frames.open_frames`.
    attachments
        The files that the experiment names, open for reading, by field: ``timestamps``, ``flat_field``, ...
    known
        Files by name whose size and checksum are known already (as they are after an upload): they are not read.
    progress
        Called as ``("ingest", files done, files)``.
    """
    attached = attachments or {}
    files, names = stack_files(source)
    with open_frames(source, Choice.of(experiment)) as frames:
        n_frames, (n_rows, n_columns), dtype = len(frames), frames.shape, str(frames.dtype)
        of_file, noticed = frames.times_s(), frames.findings()
        numbered = _numbered(frames.file_names(), n_frames, experiment)
    times_s = frame_times_s(
        experiment, n_frames, gaps=numbered.gaps, timestamps=attached.get("timestamps"), of_file=of_file
    )
    if experiment.frame_interval_s is not None:
        noticed += differing_times(experiment.frame_interval_s, numbered.gaps, of_file)
    found = []
    for n_done, name in enumerate(names, start=1):
        found.append((known or {}).get(name) or _read_through(files, name))
        progress("ingest", n_done, len(names))
    beside = [_describe(field, file) for field, file in sorted(attached.items())]
    return StackIndex(
        n_frames=n_frames,
        n_rows=n_rows,
        n_columns=n_columns,
        dtype=dtype,
        times_s=tuple(times_s.tolist()),
        temperatures_c=_temperatures_c(attached.get("temperature_log"), times_s),
        gaps=numbered.gaps,
        warnings=(*numbered.findings, *noticed),
        files=tuple(found),
        attachments=tuple(beside),
        sha256=_sha256_of_all([*found, *beside]),
    )


def _temperatures_c(log: BinaryIO | None, times_s: npt.NDArray[np.float64]) -> tuple[float, ...] | None:
    """Temperature at each time, if there is a log."""
    if log is None:
        return None
    log.seek(0)
    return tuple(parse_temperature_log(log).at(times_s).tolist())


def check_frames(frames: Frames, progress: Progress = silent, *, max_share_broken: float = 0.0) -> FrameCheck:
    """Decode every frame once, so that a broken one is known before hours of work begin.

    Parameters
    ----------
    max_share_broken
        Share of the frames that may be broken; more are an error.

    Raises
    ------
    FramesError
        Names the file and the number of the first broken frame, and says how many there are.
    """
    broken: list[tuple[int, FramesError]] = []
    identical, of_other_depth = [], []
    before: Frame | None = None
    for index in range(len(frames)):
        try:
            frame = frames.read(index)
        except FramesError as problem:
            broken.append((index, problem))
        else:
            if before is not None and _are_same(before, frame):
                identical.append(index)
            if frame.dtype != frames.dtype:
                of_other_depth.append(index)
            before = frame
        progress("ingest", index + 1, len(frames))
    if len(broken) > max_share_broken * len(frames):
        raise _first_of(broken, len(frames))
    if len(broken) == len(frames):
        raise broken[0][1]
    warnings = [
        _noticed(
            "stack.frames_broken", "{n} frames cannot be read and are left out.", [at for at, _ in broken], frames
        ),
        _noticed(
            "stack.frames_identical",
            "{n} frames are the same as the one before, pixel by pixel: the camera may have sent them twice.",
            identical,
            frames,
        ),
        _noticed("stack.depth_differs", "{n} frames have another depth than the first.", of_other_depth, frames),
    ]
    return FrameCheck(
        warnings=tuple(warning for warning in warnings if warning.n), broken_frames=tuple(at for at, _ in broken)
    )


def _are_same(one: Frame, other: Frame) -> bool:
    """Whether two frames are equal; of those that are not, a few rows say so."""
    some = slice(None, None, max(1, len(one) // 16))
    return np.array_equal(one[some], other[some]) and np.array_equal(one, other)


def _noticed(code: str, message: str, which: Sequence[int], frames: Frames) -> Finding:
    examples = (f"frame {index}: {frames.label(index)}" for index in which)
    return finding(code, message.format(n=len(which)), examples, n=len(which))


def _first_of(broken: Sequence[tuple[int, FramesError]], n_frames: int) -> FramesError:
    first = broken[0][1]
    message = first.message
    if len(broken) > 1:
        others = ", ".join([*(str(index) for index, _ in broken[1:6]), *(["..."] if len(broken) > 6 else [])])
        message = f"{message} {len(broken)} of {n_frames} frames are broken (also {others})."
    share = math.ceil(1000 * len(broken) / n_frames) / 1000
    go_on = f"To go on without them, set max_failed_frame_share to {share:g} or more in the experiment."
    hints = [hint for hint in (first.hint, go_on if 2 * len(broken) < n_frames else None) if hint]
    error = BrokenFramesError(
        message, code=first.code, file=first.file, frame=broken[0][0], hint=" ".join(hints) if hints else None
    )
    error.is_most = 2 * len(broken) >= n_frames
    return error


def _numbered(names: Sequence[str], n_frames: int, experiment: Experiment) -> Numbering:
    """Gaps between the names of files of one frame each. Between parts of a film they have no known length."""
    if len(names) == n_frames:
        return numbering(names)
    missing = numbering(names).gaps
    if missing and experiment.frame_interval_s is not None:
        raise FramesError(
            "A part of the film is missing before this file, and how long it was is not known.",
            code="frames.part_missing",
            file=names[missing[0].before_frame],
            hint="Give all parts, or timestamps; rename the files if nothing is missing.",
        )
    return Numbering()


def _read_through(files: Files, name: str) -> StackFile:
    with files.open(name) as file:
        return _describe(name, file)


def _describe(name: str, file: BinaryIO) -> StackFile:
    return StackFile(name=name, size_bytes=file.seek(0, 2), sha256=_sha256(file))


def _sha256(file: BinaryIO) -> str:
    digest = hashlib.sha256()
    file.seek(0)
    while block := file.read(_BLOCK_BYTES):
        digest.update(block)
    return digest.hexdigest()


def _sha256_of_all(files: list[StackFile]) -> str:
    return hashlib.sha256("".join(f"{file.sha256}  {file.name}\n" for file in files).encode()).hexdigest()
