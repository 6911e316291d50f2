"""Circles beside each other: which are the same droplet found twice, and how much of one is another's."""

from math import log, sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.rays import COS, N_RAYS, SIN

Column = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

CONTEXT = (
    "beside_rims",  # share of the outline that lies on the outline of a sure droplet
    "inside_disks",  # share of the outline that lies inside a sure droplet
    "nearest",  # least distance over the larger radius + |ln ratio of radii|, to any sure droplet
    "nearest_ratio",  # ln of the ratio of radii to that one
)
_REACH = 1.3
_ON_RIM, _ON_RIM_PX = 0.12, 1.5
_FAR = 9.0


def is_best_of_its_kind(
    x_px: Column, y_px: Column, r_px: Column, goodness: Column, *, distance: float, ratio: float
) -> Flags:
    """Whether no better circle is nearer than `distance` smaller radii with a radius within a factor `ratio`."""
    by_y = np.argsort(y_px, kind="stable")
    by_goodness = np.argsort(-goodness, kind="stable")
    return _best(x_px, y_px, r_px, by_y, by_goodness, distance, ratio)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _best(
    x: Column, y: Column, r: Column, by_y: npt.NDArray[np.int64], by_goodness: npt.NDArray[np.int64],
    distance: float, ratio: float,
) -> Flags:  # fmt: skip
    is_kept = np.ones(x.size, np.bool_)
    place = np.empty(x.size, np.int64)
    for k in range(x.size):
        place[by_y[k]] = k
    for best in by_goodness:
        if not is_kept[best]:
            continue
        reach = distance * r[best]
        for step in (-1, 1):
            k = place[best] + step
            while 0 <= k < x.size:
                other = by_y[k]
                if abs(y[other] - y[best]) > reach:
                    break
                smaller, larger = min(r[best], r[other]), max(r[best], r[other])
                if is_kept[other] and larger < ratio * smaller:
                    apart = (x[other] - x[best]) ** 2 + (y[other] - y[best]) ** 2
                    if apart < (distance * smaller) ** 2:
                        is_kept[other] = False
                k += step
    return is_kept


def context(x_px: Column, y_px: Column, r_px: Column, sure: Column, own: npt.NDArray[np.int64]) -> Column:
    """`CONTEXT` of n circles among the sure ones, shape (m, 3); `own` is the index of a circle among them, or -1."""
    order = np.argsort(sure[:, 1], kind="stable")
    place = np.empty(len(sure) + 1, np.int64)
    place[order] = np.arange(len(sure))
    place[-1] = -1
    result = np.empty((len(x_px), len(CONTEXT)))
    largest = float(sure[:, 2].max(initial=0.0))
    _context(x_px, y_px, r_px, np.ascontiguousarray(sure[order]), place[own], largest, result)
    return result


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _context(
    x: Column, y: Column, r: Column, sure: Column, own: npt.NDArray[np.int64], largest: float, result: Column
) -> None:
    is_beside, is_inside = np.empty(N_RAYS, np.bool_), np.empty(N_RAYS, np.bool_)
    for i in range(x.size):
        is_beside[:], is_inside[:] = False, False
        nearest, nearest_ratio = _FAR, 0.0
        reach = _REACH * (r[i] + largest) + _ON_RIM_PX
        for j in range(np.searchsorted(sure[:, 1], y[i] - reach), sure.shape[0]):
            if sure[j, 1] > y[i] + reach:
                break
            apart = sqrt((x[i] - sure[j, 0]) ** 2 + (y[i] - sure[j, 1]) ** 2)
            if j == own[i] or apart > _REACH * (r[i] + sure[j, 2]) + _ON_RIM_PX:
                continue
            ratio = log(r[i] / sure[j, 2])
            likeness = apart / max(r[i], sure[j, 2]) + abs(ratio)
            if likeness < nearest:
                nearest, nearest_ratio = likeness, ratio
            width = max(_ON_RIM_PX, _ON_RIM * sure[j, 2])
            for k in range(N_RAYS):
                dx, dy = x[i] + r[i] * COS[k] - sure[j, 0], y[i] + r[i] * SIN[k] - sure[j, 1]
                off = sqrt(dx * dx + dy * dy) - sure[j, 2]
                is_beside[k] |= abs(off) < width
                is_inside[k] |= off < 0
        result[i, 0], result[i, 1] = np.mean(is_beside), np.mean(is_inside)
        result[i, 2], result[i, 3] = nearest, nearest_ratio
