"""Which droplets became one between two frames: by where they would be, and by their volumes (section 5)."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices
from dropflow.tracking.sightings import Sightings, in_frames, near_pairs

_MOST_RESIDUAL = 3.0
"""Standard deviations by which volumes may fail to add up."""
_LEAST_GAIN = 2.0
"""Standard deviations by which the product is larger than the larger one was: else the other may just have vanished."""
_TOUCHING = 1.3
"""Centres of partners are at most this many sums of their radii apart in the frame after."""
_OFF_RADII = 0.5
_OFF_PX = 3.0
"""The product is at most this far from the centre of both volumes: a part of its radius, and px on top."""
_MOST_PARTNERS = 8
"""Trajectories that end near one product; more than that is a heap, of which the nearest are looked at."""


@dataclass(frozen=True)
class Merger:
    """Two droplets that became one; rows of `Sightings`."""

    larger: int
    smaller: int
    product: int
    """The first row in which both are one."""
    ended: tuple[int, ...]
    """Rows with which trajectories end: both, or the smaller one alone."""
    r_larger_px: float
    r_smaller_px: float
    r_px: float
    volume_residual: float
    off: float
    """Distance of the product from the centre of both volumes, over the distance allowed."""


def find_mergers(seen: Sightings, ends: Indices, next_px: Column, begins: Indices) -> list[Merger]:
    """All coalescences of some steps, each trajectory's end and each beginning in one of them at most.

    Parameters
    ----------
    seen : Sightings
    ends : ndarray of int
        Rows with which trajectories end in the frame before a step.
    next_px : ndarray, float64, shape (2, len(ends))
        Where these droplets would be in the frame after.
    begins : ndarray of int
        Rows with which trajectories begin in the frame after a step.
    """
    if not len(ends):
        return []
    found = [*_joined(seen, ends, next_px, begins), *_absorbed(seen, ends, next_px)]
    taken: set[tuple[int, bool]] = set()
    kept = []
    for merger in sorted(found, key=lambda one: (one.off + abs(one.volume_residual) / _MOST_RESIDUAL, one.product)):
        # What is the product of a step may end in the next.
        parts = {*((row, False) for row in merger.ended), (merger.product, True)}
        if not parts & taken:
            taken |= parts
            kept.append(merger)
    return sorted(kept, key=lambda one: one.product)


def _joined(seen: Sightings, ends: Indices, next_px: Column, begins: Indices) -> Iterator[Merger]:
    """Two that end where one begins."""
    (until, until_std), (since, since_std) = seen.radius_until, seen.radius_from
    places = next_px.T
    for product, near in _with_partners(seen, ends, next_px, begins):
        r_px = float(since[product])
        for pair in combinations(near, 2):
            one, other = sorted(pair, key=lambda index: -float(until[ends[index]]))
            rows = int(ends[one]), int(ends[other])
            r_1, r_2 = (float(until[row]) for row in rows)
            apart = np.hypot(*(places[one] - places[other]))
            centre = (places[one] * r_1**3 + places[other] * r_2**3) / (r_1**3 + r_2**3)
            off = _off(seen, product, centre, r_px)
            errors = [r_px**2 * since_std[product], r_1**2 * until_std[rows[0]], r_2**2 * until_std[rows[1]]]
            residual = float((r_px**3 - r_1**3 - r_2**3) / (3 * np.linalg.norm(errors)))
            has_grown = r_px**3 - r_1**3 >= _LEAST_GAIN * 3 * np.hypot(errors[0], errors[1])
            is_near = apart <= _TOUCHING * (r_1 + r_2) + _OFF_PX and off <= 1
            if is_near and has_grown and abs(residual) <= _MOST_RESIDUAL:
                yield Merger(*rows, product, rows, r_1, r_2, r_px, residual, off)


def _with_partners(seen: Sightings, ends: Indices, next_px: Column, begins: Indices) -> Iterator[tuple[int, list[int]]]:
    """Each row that begins near two or more ends, and these, the nearest first."""
    tree = cKDTree(in_frames(next_px[0], next_px[1], seen.frame[ends] + 1))
    x_px, y_px = seen.x_px[begins], seen.y_px[begins]
    reach_px = 1.5 * seen.radius_from[0][begins] + _OFF_PX
    which, index = near_pairs(tree, in_frames(x_px, y_px, seen.frame[begins]), reach_px)
    away_px = np.hypot(next_px[0, index] - x_px[which], next_px[1, index] - y_px[which])
    order = np.lexsort((index, away_px, which))
    of_begins = np.split(index[order], np.cumsum(np.bincount(which, minlength=len(begins)))[:-1])
    for product, near in zip(begins.tolist(), of_begins, strict=False):
        if len(near) > 1:
            yield product, near[:_MOST_PARTNERS].tolist()


def _absorbed(seen: Sightings, ends: Indices, next_px: Column) -> Iterator[Merger]:
    """One that ends in another, which goes on and grows by its volume."""
    (until, until_std), (since, since_std) = seen.radius_until, seen.radius_from
    reach_px = _TOUCHING * (float(until.max()) + until[ends]) + _OFF_PX
    which, after = seen.near(next_px[0], next_px[1], seen.frame[ends] + 1, reach_px)
    has_gone_on = ~seen.is_first[after]
    which, after = which[has_gone_on], after[has_gone_on]
    end, before = ends[which], after - 1
    r_1, r_2, r_px = until[before], until[end], since[after]
    apart = np.hypot(seen.x_px[after] - next_px[0, which], seen.y_px[after] - next_px[1, which])
    off = apart / (_TOUCHING * (r_1 + r_2) + _OFF_PX)
    uncertain = 3 * np.hypot(r_px**2 * since_std[after], r_1**2 * until_std[before])
    gain = r_px**3 - r_1**3
    residual = (gain - r_2**3) / np.hypot(uncertain, 3 * r_2**2 * until_std[end])
    is_one = (off <= 1) & (r_2 <= r_1) & (gain >= _LEAST_GAIN * uncertain) & (np.abs(residual) <= _MOST_RESIDUAL)
    for k in np.flatnonzero(is_one).tolist():
        larger, smaller = int(before[k]), int(end[k])
        sizes = float(r_1[k]), float(r_2[k]), float(r_px[k])
        yield Merger(larger, smaller, larger + 1, (smaller,), *sizes, float(residual[k]), float(off[k]))


def _off(seen: Sightings, product: int, centre: Column, r_px: float) -> float:
    away = np.hypot(seen.x_px[product] - centre[0], seen.y_px[product] - centre[1])
    return float(away / (_OFF_RADII * r_px + _OFF_PX))
