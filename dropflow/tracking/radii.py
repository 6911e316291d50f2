"""The radius of each droplet in the light of its whole trajectory, averaged over as many frames as the errors justify.

Radii are known to a few per cent in each frame and change slowly. How quickly they do, and how large the errors of
single frames are, the film says itself: differences between frames further and further apart grow by the one and begin
with the other. A Kalman smoother (H. Rauch, F. Tung, C. Striebel, AIAA J. 3 (1965) 1445-1450) over a random walk of
ln r then weighs each frame of a trajectory as it deserves. It starts anew where two droplets became one.
"""

from dataclasses import dataclass, field

import numba
import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.tracking.grid import Column
from dropflow.tracking.sightings import Sightings

Flags = npt.NDArray[np.bool_]

_LAGS = (1, 2, 4, 8, 16)
"""Frames between two radii that are compared."""
_LOG_CHANGE = np.linspace(-16.0, 2.0, 901)
"""Edges of the bins of ln |change of ln r|: medians from them are right to 1 %."""
_LEAST_PAIRS = 50
_NORMAL_MEDIAN = 0.6745
"""Median magnitude of a normal variable over its standard deviation."""
_USUAL_GROWTH_PER_S = 0.01
"""Of a film too short to say: standard deviation of the change of ln r in a second."""
_BIAS_STD = 0.01
"""Relative standard deviation of a radius that no averaging over frames removes."""
_MOST_JUMP = 4.0
"""A radius that changes between two frames, means of up to three before and after, by more than this many standard
deviations has jumped: another droplet was taken up, whether or not that was seen."""


@dataclass(frozen=True)
class RadiusErrors:
    """How radii behave in a film."""

    growth_per_s: float
    """Variance of the change of ln r in a second."""
    variance_scale: float
    """Variances of radii over what detection says of them."""


@dataclass
class RadiusChanges:
    """Changes of ln r along trajectories, gathered table by table; its size does not grow with them."""

    n: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros((len(_LAGS), len(_LOG_CHANGE) + 1), np.int64))
    """Pairs by their distance in frames and by how much they differ."""
    time_s: Column = field(default_factory=lambda: np.zeros(len(_LAGS)))
    """Sum of the time between the two."""
    claimed: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(_LOG_CHANGE) + 1, np.int64))
    """Neighbours by the standard deviation that detection claims of their difference."""

    def add(self, rows: pa.Table) -> None:
        """Rows of `dropflow.tables.TRAJECTORIES`, sorted by (trajectory_id, frame)."""
        ids, time_s, r_px = (rows[name].to_numpy() for name in ("trajectory_id", "time_s", "r_px"))
        log_r, variance = np.log(r_px), _claimed_variance(rows)
        for which, lag in enumerate(_LAGS):
            same = ids[lag:] == ids[:-lag]
            change = np.abs(log_r[lag:] - log_r[:-lag])[same]
            self.n[which] += _counted(change)
            self.time_s[which] += float((time_s[lag:] - time_s[:-lag])[same].sum())
            if lag == 1:
                self.claimed += _counted(np.sqrt(variance[1:] + variance[:-1])[same])

    def errors(self) -> RadiusErrors:
        """Growth and errors under which changes would be as large as they are.

        Of several lags the quickest growth is taken: radii that go up and down differ less after a whole period.
        """
        n_pairs = self.n.sum(axis=1)
        known = np.flatnonzero(n_pairs >= _LEAST_PAIRS)
        if len(known) < 2:
            return RadiusErrors(_USUAL_GROWTH_PER_S**2, 1.0)
        variance = np.array([_median(self.n[lag]) / _NORMAL_MEDIAN for lag in known]) ** 2
        apart_s = self.time_s[known] / n_pairs[known]
        per_s = (variance[1:] - variance[0]) / (apart_s[1:] - apart_s[0])
        growth = max(float(per_s[int(len(per_s) > 1) :].max()), 0.0)  # that of two frames alone is the least certain
        at_once = max(float(variance[0]) - growth * float(apart_s[0]), float(variance[0]) / 4)
        return RadiusErrors(growth, at_once / _median(self.claimed) ** 2)


def smoothed_radii(rows: pa.Table, errors: RadiusErrors, is_new: Flags) -> tuple[Column, Column]:
    """Radius (px) of each row in the light of all rows of its trajectory, and its standard deviation.

    Parameters
    ----------
    rows
        Of whole trajectories, sorted by (trajectory_id, frame).
    errors
        How radii behave in the film.
    is_new
        Rows in which a droplet is the product of a coalescence: what was before says nothing of its size.
    """
    ids, time_s, r_px = (rows[name].to_numpy() for name in ("trajectory_id", "time_s", "r_px"))
    begins = is_new | _has_jumped(Sightings.from_table(rows))
    begins[np.append(True, ids[1:] != ids[:-1])[: len(ids)]] = True
    variance = np.maximum(errors.variance_scale * _claimed_variance(rows), 1e-12)
    log_r, variance = _smoothed(np.log(r_px), variance, time_s.astype(np.float64), begins, errors.growth_per_s)
    radius = np.exp(log_r)
    return radius, radius * np.sqrt(variance + _BIAS_STD**2)


def _claimed_variance(rows: pa.Table) -> Column:
    """Of ln r, as detection says; where it says nothing, what is usual."""
    share = rows["r_std_px"].to_numpy() / rows["r_px"].to_numpy()
    is_known = np.isfinite(share) & (share > 0)
    usual = float(np.median(share[is_known])) if is_known.any() else _BIAS_STD
    return np.asarray(np.where(is_known, share, usual) ** 2)


def _has_jumped(seen: Sightings) -> Flags:
    """Rows from which on the radius is another than before."""
    (until, until_std), (since, since_std) = seen.radius_until, seen.radius_from
    n = len(until)
    jump = np.zeros(n)
    within = ~(seen.is_first[1 : n - 2] | seen.is_first[2 : n - 1] | seen.is_last[2 : n - 1])
    here = 2 + np.flatnonzero(within)
    jump[here] = np.abs(since[here] - until[here - 1]) / np.hypot(since_std[here], until_std[here - 1])
    is_highest = (jump >= np.append(0.0, jump[:-1])) & (jump > np.append(jump[1:], 0.0))
    return np.asarray(is_highest & (jump > _MOST_JUMP))


def _counted(changes: Column) -> npt.NDArray[np.int64]:
    with np.errstate(divide="ignore"):
        which = np.searchsorted(_LOG_CHANGE, np.log(changes))
    return np.bincount(which, minlength=len(_LOG_CHANGE) + 1)


def _median(counts: npt.NDArray[np.int64]) -> float:
    cumulated = np.cumsum(counts)
    at = int(np.searchsorted(cumulated, (cumulated[-1] + 1) // 2))
    step = _LOG_CHANGE[1] - _LOG_CHANGE[0]
    return float(np.exp(_LOG_CHANGE[0] + (at - 0.5) * step))


@numba.njit(cache=True)
def _smoothed(
    log_r: Column, variance: Column, time_s: Column, begins: Flags, growth_per_s: float
) -> tuple[Column, Column]:  # pragma: no cover - compiled
    """Forward through each stretch of rows and back again."""
    n = len(log_r)
    mean, spread = np.empty(n), np.empty(n)
    for row in range(n):
        if begins[row]:
            mean[row], spread[row] = log_r[row], variance[row]
            continue
        before = spread[row - 1] + growth_per_s * (time_s[row] - time_s[row - 1])
        gain = before / (before + variance[row])
        mean[row] = mean[row - 1] + gain * (log_r[row] - mean[row - 1])
        spread[row] = (1 - gain) * before
    for row in range(n - 2, -1, -1):
        if begins[row + 1]:
            continue
        ahead = spread[row] + growth_per_s * (time_s[row + 1] - time_s[row])
        gain = spread[row] / ahead
        mean[row] += gain * (mean[row + 1] - mean[row])
        spread[row] += gain * gain * (spread[row + 1] - ahead)
    return mean, spread
