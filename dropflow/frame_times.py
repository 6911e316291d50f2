"""When each frame was taken: from the interval between frames, from a CSV file, or from the frames' own file."""

import csv
import io
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np

from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import Experiment
from dropflow.frames import Finding, Times
from dropflow.frames.findings import finding
from dropflow.frames.numbering import Gap

_TOLERANCE = 0.05
"""Share of the interval by which the file's own times may differ before it is said."""


def frame_times_s(
    experiment: Experiment,
    n_frames: int,
    *,
    gaps: Sequence[Gap] = (),
    timestamps: BinaryIO | None = None,
    of_file: Times | None = None,
) -> Times:
    """Time of each frame in seconds, shape (n_frames,), strictly increasing, from the one place the experiment names.

    Parameters
    ----------
    gaps
        Frames that are missing: with `frame_interval_s`, each takes its interval, too.
    timestamps
        The CSV file that the experiment names.
    of_file
        What the frames' own file says (`Frames.times_s`), for `times_from_frames`.

    Raises
    ------
    ExperimentError
        Naming the field, if the times are missing, too few, or do not increase.
    """
    if experiment.frame_interval_s is not None:
        return _counted(n_frames, gaps) * experiment.frame_interval_s
    if experiment.times_from_frames:
        return _checked(_of_file(of_file), n_frames, "times_from_frames", "the frames' own file")
    name = str(experiment.timestamps)
    if timestamps is None:
        raise _error("timestamps", f"the file {name} is missing")
    timestamps.seek(0)
    return _checked(_read_times_s(timestamps, name), n_frames, "timestamps", name)


def differing_times(interval_s: float, gaps: Sequence[Gap], of_file: Times | None) -> tuple[Finding, ...]:
    """What to say if the frames' own file tells other times than the interval does."""
    if of_file is None or len(of_file) < 2:
        return ()
    steps_s, expected_s = np.diff(of_file), np.diff(_counted(len(of_file), gaps)) * interval_s
    wrong = np.flatnonzero(~(np.abs(steps_s - expected_s) <= _TOLERANCE * interval_s))
    if not wrong.size:
        return ()
    message = (
        f"The frames' own file tells other times: {np.nanmedian(steps_s):.6g} s between frames (median) where "
        f"frame_interval_s is {interval_s:.6g} s, which counts. Set times_from_frames to use those of the file."
    )
    examples = (f"{steps_s[at]:.6g} s from frame {at} to {at + 1}" for at in wrong)
    return (finding("stack.times_differ", message, examples, n=len(wrong)),)


def _counted(n_frames: int, gaps: Sequence[Gap]) -> Times:
    """Number of each frame if the missing ones are counted, too."""
    steps = np.ones(n_frames)
    steps[:1] = 0
    for gap in gaps:
        steps[gap.before_frame] += gap.n_missing
    counted: Times = np.cumsum(steps)
    return counted


def _of_file(times_s: Times | None) -> Times:
    if times_s is None:
        raise _error(
            "times_from_frames",
            "the frames' file tells no times: give frame_interval_s or timestamps",
        )
    return times_s


def _checked(times_s: Times, n_frames: int, field: str, name: str) -> Times:
    if len(times_s) != n_frames:
        raise _error(field, f"{name} holds {len(times_s)} times for {n_frames} frames")
    if (unknown := np.flatnonzero(~np.isfinite(times_s))).size:
        raise _error(field, f"{name} holds no time, or none that is a finite number, for frame {unknown[0]}")
    backwards = np.flatnonzero(~(np.diff(times_s) > 0))
    if backwards.size:
        raise _error(field, f"time does not increase from frame {backwards[0]} to {backwards[0] + 1} in {name}")
    return times_s


def _read_times_s(file: BinaryIO, name: str) -> Times:
    try:
        text = io.StringIO(file.read().decode("utf-8-sig"), newline="")
        rows = csv.DictReader(text)
        if "time_s" not in (rows.fieldnames or ()):
            raise _error("timestamps", f"{name} has no column time_s")
        times = [float(row["time_s"]) for row in rows]
    except (UnicodeDecodeError, csv.Error, TypeError, ValueError) as problem:
        if isinstance(problem, ExperimentError):
            raise
        raise _error("timestamps", f"{name} is not a CSV file with a number time_s in each row ({problem})") from None
    return np.array(times, np.float64)


def _error(field: str, message: str) -> ExperimentError:
    return ExperimentError("Please correct:", fields=[FieldProblem(field, message)])
