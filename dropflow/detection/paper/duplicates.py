"""Two detections of one physical droplet (end of section 3.1.2)."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from dropflow.parameters import PaperDetection

Column = npt.NDArray[np.float64]


def is_similar(r_px: Column, other_r_px: Column, knobs: PaperDetection) -> npt.NDArray[np.bool_]:
    """Whether ``0.7 < r1 / r2 < 1.4`` for either order of each pair of radii (so that no order has to be told)."""
    ratio = r_px / other_r_px
    inverse = other_r_px / r_px
    low, high = knobs.similar_ratio_min, knobs.similar_ratio_max
    return ((low < ratio) & (ratio < high)) | ((low < inverse) & (inverse < high))


def is_unique(
    x_px: Column, y_px: Column, r_px: Column, match: Column, *, knobs: PaperDetection
) -> npt.NDArray[np.bool_]:
    """Tell which of n circles stay when each physical droplet is kept once.

    Two circles are one droplet when their centres are nearer than one radius and their radii are similar. "One radius"
    is the smaller one: else small droplets on big ones are lost. The better match stays: circles are taken from the
    best match down, and one is dropped if it is the same droplet as one that stayed.

    Parameters
    ----------
    x_px, y_px, r_px, match
        Circles and how well they match, each of shape (n,).
    knobs
        Distance in radii and the limits of the ratio.

    Returns
    -------
    Shape (n,), True for those that stay. It does not depend on the order of the circles unless matches are equal.
    """
    stays = np.ones(len(x_px), np.bool_)
    if len(x_px) < 2:
        return stays
    first, second = _same_droplet(x_px, y_px, r_px, knobs)
    rank = np.empty(len(match), np.int64)
    rank[np.argsort(-match, kind="stable")] = np.arange(len(match))
    better = np.where(rank[first] < rank[second], first, second)
    worse = np.where(rank[first] < rank[second], second, first)
    for pair in np.argsort(rank[better], kind="stable"):
        if stays[better[pair]]:
            stays[worse[pair]] = False
    return stays


def _same_droplet(
    x_px: Column, y_px: Column, r_px: Column, knobs: PaperDetection
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Indices of the pairs that are one droplet."""
    reach = knobs.duplicate_distance * float(r_px.max())
    pairs = KDTree(np.column_stack([x_px, y_px])).query_pairs(reach, output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    distance = np.hypot(x_px[first] - x_px[second], y_px[first] - y_px[second])
    is_near = distance < knobs.duplicate_distance * np.minimum(r_px[first], r_px[second])
    is_same = is_near & is_similar(r_px[first], r_px[second], knobs)
    return first[is_same], second[is_same]
