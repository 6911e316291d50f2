"""Which droplet is which: by closest distance and similar radius (section 3.2.1)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column

MOST_NEIGHBOURS = 32

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Pairs:
    """`first[k]` of one set of droplets and `second[k]` of another are one droplet; each index occurs once at most."""

    first: Indices
    second: Indices

    def __len__(self) -> int:
        return len(self.first)


def all_but(n: int, some: Indices) -> Indices:
    """Indices below `n` that are not among `some`, ascending."""
    is_left = np.ones(n, bool)
    is_left[some] = False
    return np.flatnonzero(is_left)


def in_both(these: Indices, others: Indices) -> Pairs:
    """Where equal numbers stand in two ascending arrays, each without repetitions."""
    at = np.searchsorted(others, these)
    first = np.flatnonzero(np.append(others, -1)[at] == these) if len(others) else np.empty(0, np.int64)
    return Pairs(first, at[first])


def closest_pairs(
    predicted: Droplets, found: Droplets, *, reach_px: Column, similar_ratio: tuple[float, float]
) -> Pairs:
    """Pair predicted with found droplets, the closest pair first, each droplet once.

    Parameters
    ----------
    predicted, found : Droplets
    reach_px : ndarray, float64, shape (len(predicted),)
        A predicted droplet pairs with none further away than this, px.
    similar_ratio : (float, float)
        The ratio of the radii lies between these.

    Returns
    -------
    Pairs
        `first` into `predicted` (ascending), `second` into `found`. Equal distances are decided by index.
    """
    near = neighbours(predicted, found, reach_px)
    ratio = predicted.r_px[near.first] / found.r_px[near.second]
    candidates = near.where((ratio > similar_ratio[0]) & (ratio < similar_ratio[1]))
    return greedy(candidates.first, candidates.second, candidates.distance_px)


def same_droplets(these: Droplets, others: Droplets, similar_ratio: tuple[float, float]) -> Pairs:
    """Pairs that are two sightings of one droplet: nearer than the smaller radius, radii similar (section 3.1.2).

    Unlike in `closest_pairs`, an index may occur several times.
    """
    near = neighbours(these, others, these.r_px)
    r_these, r_others = these.r_px[near.first], others.r_px[near.second]
    ratio = r_these / r_others
    is_same = (near.distance_px < r_others) & (ratio > similar_ratio[0]) & (ratio < similar_ratio[1])
    return Pairs(near.first[is_same], near.second[is_same])


@dataclass(frozen=True)
class Neighbours:
    """All pairs within reach, and how far apart they are."""

    first: Indices
    second: Indices
    distance_px: Column

    def where(self, which: npt.NDArray[np.bool_]) -> "Neighbours":
        """Only the pairs at a mask."""
        return Neighbours(self.first[which], self.second[which], self.distance_px[which])


def neighbours(these: Droplets, others: Droplets, reach_px: Column) -> Neighbours:
    """All pairs of a droplet of `these` and one of `others` at most `reach_px` (one for each of `these`) apart.

    Of a droplet with more than `MOST_NEIGHBOURS` within reach only the nearest of them: what comes further is never
    the right one, and a heap of detections in one place must not cost the square of their number.
    """
    if not len(these) or not len(others):
        nothing = np.empty(0, np.int64)
        return Neighbours(nothing, nothing, np.empty(0))
    tree = cKDTree(np.column_stack([others.x_px, others.y_px]))
    n_nearest = min(MOST_NEIGHBOURS, len(others))
    places = np.column_stack([these.x_px, these.y_px])
    far = float(np.max(reach_px)) * (1 + 1e-9)
    distance, index = (
        np.reshape(found, (len(these), n_nearest)) for found in tree.query(places, n_nearest, distance_upper_bound=far)
    )
    first, rank = np.nonzero(distance <= reach_px[:, None])
    return Neighbours(first, index[first, rank], distance[first, rank])


def greedy(first: Indices, second: Indices, cost: Column) -> Pairs:
    """Of candidate pairs take the cheapest, then the cheapest whose ends are both free, and so on."""
    taken_first: dict[int, int] = {}
    taken_second: set[int] = set()
    order = np.lexsort((second, first, cost))
    for one, other in zip(first[order].tolist(), second[order].tolist(), strict=True):
        if one not in taken_first and other not in taken_second:
            taken_first[one] = other
            taken_second.add(other)
    pairs = sorted(taken_first.items())
    return Pairs(np.array([one for one, _ in pairs], np.int64), np.array([other for _, other in pairs], np.int64))
