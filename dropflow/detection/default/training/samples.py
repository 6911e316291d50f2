"""What the looks see in scenes, beside the truth: the rows that trees are grown on."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.sightings import Sightings
from dropflow.detection.default.training.scenes import Scene
from dropflow.preprocess import StackEstimate, corrected, measure_stripes, remove_stripes
from dropflow.preprocess.flat_field import normalised_flat_field

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

_FARTHEST = 0.9
"""Cost up to which a sighting belongs to a droplet ..."""
_DOUBTFUL = 0.6
"""... and from which that of a visible one is neither right nor wrong."""
_FROM_NOT_VISIBLE, _FROM_BORDERLINE = 0.35, 0.1
_LEAST_GATE_PX = 6.0
_EXACT = 0.05
"""Radii are not told apart by less than this share."""


@dataclass(frozen=True, eq=False)
class Samples:
    """n sightings of one scene; each column has shape (n,)."""

    family: str
    sightings: Sightings
    is_droplet: Column
    """1 for a visible droplet, 0 for none, NaN for what counts neither way."""
    true_row: npt.NDArray[np.int64]
    """The scene's droplet that is meant, -1 for none."""
    cost: Column


def prepared(scene: Scene) -> Image:
    """The scene's frame as the detector prepares it."""
    rows, columns = scene.frame.shape
    flat = None if scene.flat_field is None else normalised_flat_field(scene.flat_field, (rows, columns))
    image = corrected(scene.frame, StackEstimate((rows, columns), flat), scene.tone)
    remove_stripes(image, measure_stripes([image]))
    return image


def labelled(scene: Scene, seen: Sightings) -> Samples:
    """Compare sightings with the truth.

    The cost of a pair is its distance over half the radius (of at least 6 px) plus 1.5 |ln of the ratio of radii|, the
    fitted one to where the droplet's edge is. Of several sightings of one droplet the best is right; others, unless
    they are so near to it that only one will be kept, are wrong.
    """
    n = len(seen)
    is_droplet, true_row, cost = np.zeros(n), np.full(n, -1, np.int64), np.full(n, np.inf)
    if len(scene.r_px) == 0:
        return Samples(scene.family, seen, is_droplet, true_row, cost)
    handicap = _FROM_NOT_VISIBLE * scene.is_not_visible
    handicap = np.where(scene.is_visible | scene.is_not_visible, handicap, _FROM_BORDERLINE)
    for i in range(n):
        distance = np.hypot(scene.x_px - seen.x_px[i], scene.y_px - seen.y_px[i])
        off = np.maximum(np.abs(np.log(seen.r_px[i] / scene.edge_px)) - _EXACT, 0.0)
        costs = 2 * distance / np.maximum(_LEAST_GATE_PX, scene.r_px) + 1.5 * off + handicap
        best = int(np.argmin(costs))
        if costs[best] > _FARTHEST:
            continue
        true_row[i], cost[i] = best, costs[best]
        if scene.is_visible[best]:
            is_droplet[i] = 1.0 if cost[i] <= _DOUBTFUL else np.nan
        elif not scene.is_not_visible[best]:
            is_droplet[i] = np.nan
    _once_each(seen, is_droplet, true_row, cost)
    return Samples(scene.family, seen, is_droplet, true_row, cost)


def _once_each(seen: Sightings, is_droplet: Column, true_row: npt.NDArray[np.int64], cost: Column) -> None:
    """Leave one right sighting a droplet, in place."""
    best: dict[int, int] = {}
    for i in np.argsort(cost, kind="stable"):
        row = int(true_row[i])
        if row < 0 or is_droplet[i] != 1.0:
            continue
        if row not in best:
            best[row] = int(i)
            continue
        pair = seen[np.array([best[row], i])]
        is_same = not pair.best(np.array([1.0, 0.0]))[1]
        is_droplet[i] = np.nan if is_same else 0.0
