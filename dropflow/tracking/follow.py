"""A predicted droplet that no known one is: looked for in the image (sections 3.3.1 and 3.3.2)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.tracking.identification import Indices, Pairs, all_but, greedy, same_droplets

Look = Callable[[Droplets], tuple[Droplets, npt.NDArray[np.bool_]]]
"""`dropflow.detection.contract.Detector.find_near` on the image of one frame."""


@dataclass(frozen=True)
class Followed:
    """What became of predicted droplets. A droplet in neither part was lost."""

    paired: Pairs
    """Predicted droplets that are one of the candidates."""
    searched: Indices
    """Predicted droplets that only the image showed, ascending."""
    sighted: Droplets
    """Where the image showed them, as many as `searched`."""


def follow(
    predicted: Droplets,
    paired: Pairs,
    candidates: Droplets,
    *,
    taken: Droplets,
    look: Look | None,
    similar_ratio: tuple[float, float],
) -> Followed:
    """Find in the image those predicted droplets that are not `paired` with one of the `candidates`.

    What the image shows at one of the `taken` droplets (they belong to other trajectories) would be a branch and is
    given up; what it shows at a candidate nobody has claimed is that candidate.
    """
    nothing = Followed(paired, np.empty(0, np.int64), Droplets.empty())
    if look is None or len(paired) == len(predicted):
        return nothing
    missing = all_but(len(predicted), paired.first)
    sighted, is_good = look(predicted[missing])
    missing, sighted = missing[is_good], sighted[is_good]
    claimed = Droplets.concatenate([taken, candidates[paired.second]])
    is_branch = np.isin(np.arange(len(missing)), same_droplets(sighted, claimed, similar_ratio).first)
    missing, sighted = missing[~is_branch], sighted[~is_branch]
    kept = _without_twins(predicted[missing], sighted, similar_ratio)
    missing, sighted = missing[kept], sighted[kept]
    free = all_but(len(candidates), paired.second)
    same = same_droplets(sighted, candidates[free], similar_ratio)
    distance = _distance(sighted[same.first], candidates[free[same.second]])
    recovered = greedy(same.first, same.second, distance)
    first = np.concatenate([paired.first, missing[recovered.first]])
    second = np.concatenate([paired.second, free[recovered.second]])
    order = np.argsort(first)
    is_new = ~np.isin(np.arange(len(missing)), same.first)
    return Followed(Pairs(first[order], second[order]), missing[is_new], sighted[is_new])


def _without_twins(expected: Droplets, sighted: Droplets, similar_ratio: tuple[float, float]) -> npt.NDArray[np.bool_]:
    """Of several predictions that led to one droplet only the nearest is it."""
    kept = np.ones(len(sighted), bool)
    off_px = _distance(expected, sighted)
    twins = same_droplets(sighted, sighted, similar_ratio)
    nearest_first = np.lexsort((twins.second, twins.first, off_px[twins.first]))
    for one, other in zip(twins.first[nearest_first].tolist(), twins.second[nearest_first].tolist(), strict=True):
        if one != other and kept[one]:
            kept[other] = False
    return kept


def _distance(these: Droplets, others: Droplets) -> npt.NDArray[np.float64]:
    return np.hypot(these.x_px - others.x_px, these.y_px - others.y_px)
