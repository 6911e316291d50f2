"""The outline of a droplet: brightness along rays from its centre, and a circle through where it falls fastest.

All distances are in radii of the circle at hand, so that a droplet of 6 px and one of 60 px are treated alike.
"""

from math import cos, pi, sin, sqrt

import numba
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

N_RAYS = 32
STEP = 0.05
"""Distance between samples along a ray, in radii."""
N_STEPS = 41
"""Samples along a ray: from the centre to two radii."""
REACHES = (0.35, 0.22, 0.12)
"""How far (standard deviation, in radii) from the circle at hand an edge is believed, by iteration."""
OUTLIER_LEAST = 0.05
"""Edges within this many radii of the circle are never outliers."""
_COS = np.array([cos(2 * pi * k / N_RAYS) for k in range(N_RAYS)])
_SIN = np.array([sin(2 * pi * k / N_RAYS) for k in range(N_RAYS)])
OUTSIDE = np.float32(np.nan)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def sample(image: Image, x: float, y: float, r: float, polar: Polar) -> None:
    """Fill `polar` (ray, step) with brightness at distance step * STEP * r; NaN outside the frame."""
    rows, columns = image.shape
    for k in range(N_RAYS):
        dx, dy = _COS[k] * STEP * r, _SIN[k] * STEP * r
        for j in range(N_STEPS):
            px, py = x + dx * j, y + dy * j
            if px < 0.0 or py < 0.0 or px > columns - 1.0 or py > rows - 1.0:
                polar[k, j] = OUTSIDE
                continue
            column, row = min(int(px), columns - 2), min(int(py), rows - 2)
            fx, fy = np.float32(px - column), np.float32(py - row)
            top = image[row, column] + fx * (image[row, column + 1] - image[row, column])
            bottom = image[row + 1, column] + fx * (image[row + 1, column + 1] - image[row + 1, column])
            polar[k, j] = top + fy * (bottom - top)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def find_edges(polar: Polar, reach: float, edge: Column, drop: Column) -> int:
    """Where each ray falls fastest near distance 1: `edge` in radii (NaN where there is none), `drop` the fall there.

    Returns how many rays have an edge.
    """
    n_found = 0
    first, last = max(3, int((1.0 - 2.0 * reach) / STEP)), min(N_STEPS - 4, int((1.0 + 2.0 * reach) / STEP) + 1)
    for k in range(N_RAYS):
        best, best_j = 0.0, -1
        for j in range(first, last + 1):
            fall = _fall(polar, k, j)
            away = (j * STEP - 1.0) / reach
            value = fall * (1.0 - 0.125 * away * away * (2.0 - 0.25 * away * away))
            if value > best:
                best, best_j = value, j
        edge[k], drop[k] = np.nan, 0.0
        if best_j < 0:
            continue
        here, before, after = _fall(polar, k, best_j), _fall(polar, k, best_j - 1), _fall(polar, k, best_j + 1)
        bend = before - 2.0 * here + after
        shift = 0.0
        if bend < 0.0:
            shift = min(max(0.5 * (before - after) / bend, -0.5), 0.5)
        edge[k], drop[k] = (best_j + shift) * STEP, here
        n_found += 1
    return n_found


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _fall(polar: Polar, k: int, j: int) -> float:
    """How much brightness falls across step `j`, smoothed over a fifth of a radius; NaN compares as no edge."""
    inside = polar[k, j - 1] + polar[k, j - 2] + polar[k, j - 3] * np.float32(0.5)
    outside = polar[k, j + 1] + polar[k, j + 2] + polar[k, j + 3] * np.float32(0.5)
    return (inside - outside) * 0.4


@numba.njit(cache=True, nogil=True, error_model="numpy")
def fit_circle(edge: Column, drop: Column, circle: Column, weight: Column) -> float:
    """Circle through the edges, robust against a few that belong to something else.

    `circle` receives the shift in x and y and the radius, all in old radii. Returns the spread of the edges around it
    (NaN if fewer than 6 rays have one).
    """
    strongest = 0.0
    n_edges = 0
    for k in range(N_RAYS):
        if drop[k] > 0.0:
            strongest += drop[k]
            n_edges += 1
    if n_edges < 6:
        return np.nan
    typical = strongest / n_edges
    for k in range(N_RAYS):
        weight[k] = min(drop[k] / typical, 1.0) if drop[k] > 0.0 else 0.0
    circle[0] = circle[1] = 0.0
    circle[2] = 1.0
    spread = np.nan
    for step in range(4):
        if step > 0:
            limit = max(OUTLIER_LEAST, 2.5 * spread)
            for k in range(N_RAYS):
                weight[k] = 0.0
                if drop[k] > 0.0:
                    away = abs(edge[k] - (circle[2] + circle[0] * _COS[k] + circle[1] * _SIN[k])) / limit
                    if away < 1.0:
                        weight[k] = min(drop[k] / typical, 1.0) * (1.0 - away * away) ** 2
        if not _solve(edge, weight, circle):
            return np.nan
        spread = _spread(edge, drop, circle)
    return spread


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _solve(edge: Column, weight: Column, circle: Column) -> bool:
    """Weighted least squares of edge = radius + dx cos + dy sin."""
    s1 = sc = ss = scc = sss = scs = e1 = ec = es = 0.0
    for k in range(N_RAYS):
        w = weight[k]
        if w > 0.0:
            c, s, e = _COS[k], _SIN[k], edge[k]
            s1 += w
            sc += w * c
            ss += w * s
            scc += w * c * c
            sss += w * s * s
            scs += w * c * s
            e1 += w * e
            ec += w * e * c
            es += w * e * s
    if s1 <= 0.0:
        return False
    ridge = 1e-3 * s1
    scc += ridge
    sss += ridge
    a, b, c2 = scc - sc * sc / s1, scs - sc * ss / s1, sss - ss * ss / s1
    u, v = ec - sc * e1 / s1, es - ss * e1 / s1
    determinant = a * c2 - b * b
    if determinant <= 1e-9 * s1 * s1:
        return False
    circle[0] = (u * c2 - v * b) / determinant
    circle[1] = (v * a - u * b) / determinant
    circle[2] = (e1 - circle[0] * sc - circle[1] * ss) / s1
    return True


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _spread(edge: Column, drop: Column, circle: Column) -> float:
    """Median distance of edges from the circle, as a standard deviation."""
    away = np.empty(N_RAYS)
    n = 0
    for k in range(N_RAYS):
        if drop[k] > 0.0:
            away[n] = abs(edge[k] - (circle[2] + circle[0] * _COS[k] + circle[1] * _SIN[k]))
            n += 1
    return 1.4826 * float(np.median(away[:n]))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def refine(image: Image, x: Column, y: Column, r: Column, spread: Column) -> None:
    """Fit a circle at each of n places, in place; `spread` (in radii) is NaN where there is none."""
    polar = np.empty((N_RAYS, N_STEPS), np.float32)
    edge, drop, circle, weight = np.empty(N_RAYS), np.empty(N_RAYS), np.empty(3), np.empty(N_RAYS)
    for i in range(x.size):
        start_x, start_y, start_r = x[i], y[i], r[i]
        for reach in REACHES:
            sample(image, x[i], y[i], r[i], polar)
            find_edges(polar, reach, edge, drop)
            spread[i] = fit_circle(edge, drop, circle, weight)
            if not spread[i] >= 0.0:
                break
            shift = sqrt(circle[0] ** 2 + circle[1] ** 2)
            limit = min(1.0, 0.5 / max(shift, 1e-9))
            x[i] += circle[0] * limit * r[i]
            y[i] += circle[1] * limit * r[i]
            r[i] *= min(max(circle[2], 0.6), 1.6)
        if abs(x[i] - start_x) + abs(y[i] - start_y) > 2.0 * start_r or not 0.3 * start_r < r[i] < 3.0 * start_r:
            spread[i] = np.nan


@numba.njit(cache=True, nogil=True, error_model="numpy")
def mean_profile(polar: Polar, weight: Column, profile: Column) -> None:
    """Brightness by distance, averaged over rays by their weight; NaN where no ray is inside the frame."""
    for j in range(N_STEPS):
        total = total_weight = 0.0
        for k in range(N_RAYS):
            level = polar[k, j]
            if weight[k] > 0.0 and level == level:
                total += weight[k] * level
                total_weight += weight[k]
        profile[j] = total / total_weight if total_weight > 0.0 else np.nan
