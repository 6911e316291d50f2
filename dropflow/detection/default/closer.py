"""A closer look at candidates: fit a circle to each, and measure what tells whether it is a droplet."""

from math import sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.centre import better_shift
from dropflow.detection.default.features import N_FEATURES, measure
from dropflow.detection.default.pyramid import Level, level_of
from dropflow.detection.default.rays import (
    COS,
    N_PROFILE,
    N_RAYS,
    N_STEPS,
    RIM,
    SIN,
    add_own,
    find_edges,
    fit_circle,
    sample,
)

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

FINEST_PX = 6.0
"""Droplets are looked at on the level where their radius is this to twice this many pixels (or at full size)."""
_REACHES = (0.35, 0.2, 0.12)
"""How far from the circle at hand an edge is believed (standard deviation, in radii), by iteration."""
_STRIDES = (2, 2, 1)
"""Steps between the samples of the search for edges, by iteration: the first ones only have to come near."""
_RAY_STRIDES = (2, 2, 1)
_FARTHEST = 0.5
"""A circle moves at most this many radii in one iteration."""
_LEAST_ON_CIRCLE = 0.35
"""Candidates with fewer edges than this share on their circle are given up early."""

NO_OWN = np.empty((0, 3))
NO_PROFILES = np.empty((0, N_PROFILE), np.float32)


def look_closer(
    levels: list[Level], noise: float, x_px: Column, y_px: Column, r_px: Column, *, n_iterations: int = 3,
    own: Column = NO_OWN, profiles: Polar = NO_PROFILES,
) -> tuple[Column, Column, Column, Column]:  # fmt: skip
    """Fit and measure n candidates.

    Parameters
    ----------
    levels, noise
        Pyramid of an image, and the standard deviation of a pixel at full size.
    x_px, y_px, r_px
        Where to begin, each of shape (n,).
    n_iterations
        3 from afar, fewer from a place that is nearly right.
    own, profiles
        Droplets (x, y, r), shape (n, 3), and their profiles, shape (n, N_PROFILE), that were taken out of the image and
        are put back, each for its own candidate alone.

    Returns
    -------
    x_px, y_px, r_px, shape (n,), and features, shape (n, N_FEATURES), whose rows are NaN where there is no circle.
    """
    x, y, r = x_px.copy(), y_px.copy(), r_px.copy()
    features = np.full((len(x), N_FEATURES), np.nan)
    which = level_of(r_px, levels, finest_px=FINEST_PX)
    for index, level in enumerate(levels):
        here = np.flatnonzero(which == index)
        if len(here) == 0:
            continue
        # Neighbours one after another: their pixels are still in the cache.
        here = here[np.lexsort((x[here], y[here] // (32 * level.factor)))]
        local = np.stack([level.x_from_frame(x[here]), level.x_from_frame(y[here]), r[here] / level.factor])
        local_own, local_profiles = NO_OWN, NO_PROFILES
        if len(own):
            local_own = np.column_stack([level.x_from_frame(own[here, :2]), own[here, 2] / level.factor])
            local_profiles = profiles[here]
        found = np.empty((len(here), N_FEATURES))
        circles = local[0], local[1], local[2]
        _look(level.image, level.factor, noise / level.factor, circles, n_iterations, local_own, local_profiles, found)
        x[here], y[here], r[here] = level.x_to_frame(local[0]), level.x_to_frame(local[1]), local[2] * level.factor
        features[here] = found
    return x, y, r, features


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _look(
    image: Image,
    factor: float,
    noise: float,
    circles: tuple[Column, Column, Column],
    n_iterations: int,
    own: Column,
    profiles: Polar,
    features: Column,
) -> None:
    x, y, r = circles
    polar = np.empty((N_RAYS, N_STEPS), np.float32)
    edge, drop, circle, weight = np.empty(N_RAYS), np.empty(N_RAYS), np.empty(3), np.empty(N_RAYS)
    for i in range(x.size):
        start_x, start_y, start_r = x[i], y[i], r[i]
        features[i, :] = np.nan
        is_circle = True
        for iteration in range(len(_REACHES) - n_iterations, len(_REACHES)):
            is_last = iteration == len(_REACHES) - 1
            reach, stride, ray_stride = _REACHES[iteration], _STRIDES[iteration], _RAY_STRIDES[iteration]
            n_each_way = min(int(2.0 * reach * RIM) // stride, (N_STEPS - 1 - RIM) // stride - 2)
            first, last = RIM - n_each_way * stride, RIM + n_each_way * stride
            begin, end = (0, N_STEPS - 1) if is_last else (first - 2 * stride, last + 2 * stride)
            sample(image, x[i], y[i], r[i], begin, end, stride, ray_stride, polar)
            if own.shape[0] > 0:
                add_own(x[i], y[i], r[i], own[i], profiles[i], begin, end, stride, ray_stride, polar)
            find_edges(polar, reach, first, last, stride, ray_stride, edge, drop)
            spread = fit_circle(edge, drop, circle, weight)
            n_rays = N_RAYS // ray_stride
            if not spread >= 0.0 or _n_on_circle(edge, drop, circle) < _LEAST_ON_CIRCLE * n_rays:
                is_circle = False
                break
            if is_last:
                measure(polar, edge, drop, weight, spread, r[i] * factor, noise, features[i])
                better_shift(polar, weight, noise, circle)
            shift = sqrt(circle[0] ** 2 + circle[1] ** 2)
            limit = min(1.0, _FARTHEST / max(shift, 1e-9))
            x[i] += circle[0] * limit * r[i]
            y[i] += circle[1] * limit * r[i]
            r[i] *= min(max(circle[2], 0.6), 1.6)
        moved = abs(x[i] - start_x) + abs(y[i] - start_y)
        if not is_circle or moved > 2.0 * start_r or not 0.3 * start_r < r[i] < 3.0 * start_r:
            features[i, :] = np.nan


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _n_on_circle(edge: Column, drop: Column, circle: Column) -> int:
    """Rays whose edge is within 0.15 radii of the circle."""
    n = 0
    for k in range(N_RAYS):
        if drop[k] > 0.0:
            n += abs(edge[k] - (circle[2] + circle[0] * COS[k] + circle[1] * SIN[k])) < 0.15
    return n
