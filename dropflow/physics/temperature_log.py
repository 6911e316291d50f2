"""The temperature that was measured beside a film, and the driving parameter that follows from it (eq. 1)."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from dropflow.errors import ExperimentError, FieldProblem
from dropflow.physics.binodal import Binodal

Floats = npt.NDArray[np.float64]

COLUMNS = ("time_s", "temperature_c")
LONGEST_GAP_S = 120.0
MOST_BYTES = 64 << 20
_LEAST_KELVIN = 200.0


@dataclass(frozen=True)
class TemperatureLog:
    """Temperatures over time, rising in time, without gaps longer than the limit it was read with."""

    time_s: Floats
    """Shape (n,)."""
    temperature_c: Floats
    """Shape (n,)."""

    def at(self, time_s: npt.ArrayLike) -> Floats:
        """Temperature at times of any shape, C, linear between entries.

        Raises
        ------
        ExperimentError
            A time is before the first or after the last entry.
        """
        times_s = np.asarray(time_s, np.float64)
        if times_s.size and (times_s.min() < self.time_s[0] or times_s.max() > self.time_s[-1]):
            raise _problem(
                f"covers {self.time_s[0]:g} to {self.time_s[-1]:g} s, "
                f"but the film lasts from {times_s.min():g} to {times_s.max():g} s",
                hint="Correct the times of the frames (frame_interval_s), or give a log that covers the whole film.",
            )
        return np.asarray(np.interp(times_s, self.time_s, self.temperature_c))


def read_temperature_log(path: Path, *, longest_gap_s: float = LONGEST_GAP_S) -> TemperatureLog:
    """Read a CSV file from disk: see `parse_temperature_log`."""
    try:
        with path.open("rb") as file:
            return parse_temperature_log(file, name=str(path), longest_gap_s=longest_gap_s)
    except OSError:
        raise _problem("cannot be read as text", file=str(path)) from None


def parse_temperature_log(
    source: BinaryIO, *, name: str | None = None, longest_gap_s: float = LONGEST_GAP_S
) -> TemperatureLog:
    """Read a CSV file with the columns ``time_s`` and ``temperature_c``.

    Parameters
    ----------
    source
        Open for reading; at most `MOST_BYTES` long.
    name
        What errors call it.
    longest_gap_s
        Time without an entry beyond which a temperature between would be a guess.

    Raises
    ------
    ExperimentError
        Field ``temperature_log``: columns of other names or units, a number that is none, times that do not rise, a
        gap longer than `longest_gap_s`, or temperatures that can only be kelvin.
    """
    content = source.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise _problem(f"is longer than {MOST_BYTES >> 20} MiB: thin it out", file=name)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise _problem("cannot be read as text", file=name) from None
    rows = csv.DictReader(text.splitlines())
    if rows.fieldnames is None or not set(COLUMNS) <= set(rows.fieldnames):
        found = ", ".join(rows.fieldnames or []) or "none"
        raise _problem(f"must have the columns time_s (seconds) and temperature_c (°C), not {found}", file=name)
    values = np.empty((0, 2))
    try:
        values = np.array([[float(row[name]) for name in COLUMNS] for row in rows]).reshape(-1, 2)
    except (TypeError, ValueError):
        raise _problem("has an entry that is not a number", file=name) from None
    log = TemperatureLog(values[:, 0], values[:, 1])
    _check(log, name, longest_gap_s)
    return log


def _check(log: TemperatureLog, path: str | None, longest_gap_s: float) -> None:
    if len(log.time_s) < 2:
        raise _problem("needs two entries at least", file=path)
    if not (np.isfinite(log.time_s).all() and np.isfinite(log.temperature_c).all()):
        raise _problem("has an entry that is not a finite number", file=path)
    steps_s = np.diff(log.time_s)
    if (steps_s <= 0).any():
        line = int(np.argmax(steps_s <= 0)) + 3
        raise _problem(f"must rise in time, but does not at line {line}", file=path)
    if steps_s.max() > longest_gap_s:
        begin_s = log.time_s[int(np.argmax(steps_s))]
        raise _problem(f"has a gap of {steps_s.max():g} s after {begin_s:g} s (at most {longest_gap_s:g} s)", file=path)
    if log.temperature_c.min() > _LEAST_KELVIN:
        raise _problem(f"begins at {log.temperature_c[0]:g}: this can only be kelvin, °C are asked for", file=path)


def _problem(message: str, *, file: str | None = None, hint: str | None = None) -> ExperimentError:
    return ExperimentError(
        "The temperature log cannot be used.",
        code="experiment.temperature_log",
        file=file,
        fields=[FieldProblem("temperature_log", message)],
        hint=hint,
    )


@dataclass(frozen=True)
class Driving:
    """The driving parameter over time."""

    time_s: Floats
    """Middle of each window, shape (n,)."""
    temperature_c: Floats
    driving_per_s: Floats
    """xi = d ln(Phi_0(T)) / dt."""
    driving_std_per_s: Floats
    """Standard error of the slope in its window."""

    @property
    def mean_per_s(self) -> float:
        """Mean over the windows; NaN where there is none."""
        return float(self.driving_per_s.mean()) if len(self.driving_per_s) else np.nan

    @property
    def mean_std_per_s(self) -> float:
        """Standard error of the mean, from the scatter between windows; NaN for fewer than two."""
        n = len(self.driving_per_s)
        return float(self.driving_per_s.std(ddof=1) / np.sqrt(n)) if n > 1 else np.nan


def driving_from_log(log: TemperatureLog, binodal: Binodal, *, window_s: float = 600.0) -> Driving:
    """xi(t) as the slope of ln(Phi_0) against time in windows beside each other (eq. 1).

    Entries in the one-phase region or at its border have no Phi_0 and are left out; a window needs three entries.
    """
    low, high = binodal.range_c
    is_two_phase = (log.temperature_c > low) & (log.temperature_c <= high)
    time_s, temperature_c = log.time_s[is_two_phase], log.temperature_c[is_two_phase]
    log_width = np.log(binodal.half_width(temperature_c)) if len(time_s) else np.empty(0)
    window = np.floor((time_s - log.time_s[0]) / window_s).astype(np.int64)
    found = []
    for number in np.unique(window):
        inside = window == number
        if inside.sum() >= 3:
            found.append(
                (time_s[inside].mean(), temperature_c[inside].mean(), *_slope(time_s[inside], log_width[inside]))
            )
    return Driving(*np.array(found).reshape(-1, 4).T)


def _slope(x: Floats, y: Floats) -> tuple[float, float]:
    """Least-squares slope and its standard error."""
    from_mean = x - x.mean()
    spread = float((from_mean**2).sum())
    slope = float((from_mean * y).sum()) / spread
    residual = y - y.mean() - slope * from_mean
    return slope, float(np.sqrt((residual**2).sum() / (len(x) - 2) / spread)) if len(x) > 2 else np.inf
