"""Temperature ramps with a constant driving parameter (eqs. 1 and 2, section 2.3)."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
import numpy.typing as npt

from dropflow.errors import ParametersError
from dropflow.physics.binodal import Binodal

Floats = npt.NDArray[np.float64]

N_STEPS = 10_000
LONGEST_S = 1e7
"""A ramp of four months; its set points are ten million."""
_ROWS_AT_ONCE = 10_000
_CURVE_POINTS = 4096


@dataclass(frozen=True)
class Ramp:
    """A temperature ramp, uniform in time."""

    driving_per_s: float
    """xi, the driving parameter."""
    time_s: Floats
    """Shape (n_steps + 1,), from 0."""
    temperature_c: Floats
    """Shape (n_steps + 1,)."""

    @property
    def duration_s(self) -> float:
        """From start to end."""
        return float(self.time_s[-1])

    def at(self, time_s: npt.ArrayLike) -> Floats:
        """Temperature at times of any shape, C; before and after the ramp that of its ends."""
        return np.asarray(np.interp(np.asarray(time_s, np.float64), self.time_s, self.temperature_c))


def temperature_ramp(
    binodal: Binodal,
    *,
    start_c: float = 25.8,
    end_c: float = 50.0,
    driving_per_s: float | None = None,
    duration_s: float | None = None,
    n_steps: int = N_STEPS,
) -> Ramp:
    """The ramp that keeps xi = d ln(Phi_0) / dt constant, from one temperature to another (eq. 2).

    Parameters
    ----------
    binodal
        Gives Phi_0(T) and its derivative.
    start_c, end_c
        Temperatures at start and end, C; the paper's are 25.8 and 50.
    driving_per_s, duration_s
        Give xi (1/s) or how long the ramp takes (s); the other follows.
    n_steps
        Uniform steps of the explicit integration; the paper takes 10,000.

    Raises
    ------
    ParametersError
        Not exactly one of xi and duration, not positive, no rise from start to end, or longer than `LONGEST_S`.
    ExperimentError
        A temperature is outside the binodal.
    """
    if (driving_per_s is None) == (duration_s is None):
        raise ParametersError("A ramp needs either a driving parameter xi or a duration.")
    given = driving_per_s if driving_per_s is not None else duration_s
    if given is None or not np.isfinite(given) or given <= 0:
        raise ParametersError(f"A driving parameter or a duration is positive, not {given}.")
    if not start_c < end_c:
        raise ParametersError(f"The ramp must rise: it begins at {start_c} °C and ends at {end_c} °C.")
    growth, temperature_c = _path(binodal, start_c, end_c, n_steps)
    duration = growth / driving_per_s if driving_per_s is not None else float(duration_s or 0)
    if duration > LONGEST_S:
        raise ParametersError(
            f"The ramp would take {duration:.3g} s; {LONGEST_S:.0e} s is the longest: give a larger driving parameter."
        )
    return Ramp(growth / duration, np.linspace(0, duration, n_steps + 1), temperature_c)


def _path(binodal: Binodal, start_c: float, end_c: float, n_steps: int) -> tuple[float, Floats]:
    """The product of xi and duration for which eq. (2) ends where it should, and the temperatures on the way.

    Eq. (2) knows xi and the time step only as their product, so one path serves every ramp.
    """
    # Points dense near the start, where close to a critical point the slope changes fast.
    curve_c = start_c + (end_c - start_c) * np.linspace(0, 1, _CURVE_POINTS) ** 3
    rate_c = binodal.half_width(curve_c) / binodal.half_width_slope_per_k(curve_c)

    def integrate(growth: float) -> Floats:
        path = np.empty(n_steps + 1)
        path[0] = here = start_c
        step = growth / n_steps
        for index in range(1, n_steps + 1):
            here += step * float(np.interp(here, curve_c, rate_c))
            path[index] = here
        return path

    from scipy.optimize import brentq

    exact = float(np.log(binodal.half_width(end_c) / binodal.half_width(start_c)))
    growth = float(brentq(lambda g: integrate(g)[-1] - end_c, 0.9 * exact, 1.1 * exact, xtol=1e-9, rtol=1e-9))
    path = integrate(growth)
    path[-1] = end_c
    return growth, path


@dataclass(frozen=True)
class Protocol:
    """What is done around the ramp (section 2.3)."""

    mixing_c: float = 24.0
    mixing_s: float = 3600.0
    equilibration_s: float = 4 * 3600.0
    """At the temperature at which the ramp begins."""


def ramp_rows(ramp: Ramp, protocol: Protocol | None = None) -> Iterator[tuple[float, float, str]]:
    """Set points at 1 Hz: time (s), temperature (C) and stage; with a protocol, what comes before the ramp too."""
    begin_s = 0.0
    if protocol is not None:
        start_c = float(ramp.temperature_c[0])
        stages = (
            (protocol.mixing_s, protocol.mixing_c, "mixing"),
            (protocol.equilibration_s, start_c, "equilibration"),
        )
        for duration_s, temperature_c, stage in stages:
            for second in np.arange(np.ceil(duration_s)):
                yield begin_s + float(second), temperature_c, stage
            begin_s += float(np.ceil(duration_s))
    n_seconds = int(ramp.duration_s) + 1
    for first in range(0, n_seconds, _ROWS_AT_ONCE):
        seconds = np.arange(first, min(first + _ROWS_AT_ONCE, n_seconds), dtype=np.float64)
        for at_s, temperature_c in zip(seconds, ramp.at(seconds), strict=True):
            yield begin_s + float(at_s), float(temperature_c), "ramp"


def ramp_csv(ramp: Ramp, protocol: Protocol | None = None) -> Iterator[str]:
    """The set points as CSV (``time_s``, ``temperature_c``, ``stage``), some thousand lines at once."""
    yield "time_s,temperature_c,stage\n"
    lines = (
        f"{time_s:.0f},{temperature_c:.4f},{stage}\n" for time_s, temperature_c, stage in ramp_rows(ramp, protocol)
    )
    while text := "".join(islice(lines, _ROWS_AT_ONCE)):
        yield text
