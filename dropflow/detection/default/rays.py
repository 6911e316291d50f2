"""Brightness along rays from a droplet's centre, and a circle through where it falls fastest.

Distances are in radii of the circle at hand, so that a droplet of 6 px and one of 60 px are treated alike.
"""

from math import cos, pi, sin, sqrt

import numba
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

N_RAYS = 24
RIM = 16
"""Samples from the centre to one radius."""
STEP = 1.0 / RIM
"""Distance between samples along a ray, in radii."""
N_STEPS = 32
"""Samples along a ray, from the centre to nearly two radii."""
N_PROFILE = 28
"""Samples of a droplet's own profile."""
COS = np.array([cos(2 * pi * k / N_RAYS) for k in range(N_RAYS)], np.float32)
SIN = np.array([sin(2 * pi * k / N_RAYS) for k in range(N_RAYS)], np.float32)

_OUTLIER_LEAST = 0.05
"""Edges within this many radii of the circle are never outliers."""
_LEAST_EDGES = 6


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract", "nsz", "arcp"})
def sample(
    image: Image, x: float, y: float, r: float, first: int, last: int, stride: int, ray_stride: int, polar: Polar
) -> bool:
    """Fill `polar` (ray, step) from step `first` to `last` with brightness at distance step * STEP * r.

    NaN outside the frame; returns whether all of it is inside.
    """
    rows, columns = image.shape
    reach = r * STEP * last
    is_inside = x - reach >= 0 and y - reach >= 0 and x + reach < columns - 1 and y + reach < rows - 1
    x0, y0, step = np.float32(x), np.float32(y), np.float32(STEP * r)
    for k in range(0, N_RAYS, ray_stride):
        dx, dy = COS[k] * step, SIN[k] * step
        for j in range(first, last + 1, stride):
            px, py = x0 + dx * np.float32(j), y0 + dy * np.float32(j)
            if not is_inside and not (px >= 0 and py >= 0 and px <= columns - 1 and py <= rows - 1):
                polar[k, j] = np.nan
                continue
            column, row = int(px), int(py)
            if not is_inside:
                column, row = min(column, columns - 2), min(row, rows - 2)
            fx, fy = px - np.float32(column), py - np.float32(row)
            top = image[row, column] + fx * (image[row, column + 1] - image[row, column])
            bottom = image[row + 1, column] + fx * (image[row + 1, column + 1] - image[row + 1, column])
            polar[k, j] = top + fy * (bottom - top)
    return is_inside


@numba.njit(cache=True, nogil=True, error_model="numpy")
def add_own(
    x: float, y: float, r: float, own: Column, profile: Polar,
    first: int, last: int, stride: int, ray_stride: int, polar: Polar,
) -> None:  # fmt: skip
    """Add to `polar` around (x, y, r) a droplet at `own` (x, y, r) with this profile."""
    scale = np.float32(1.0 / (own[2] * STEP))
    x0, y0, step = np.float32(x - own[0]), np.float32(y - own[1]), np.float32(STEP * r)
    for k in range(0, N_RAYS, ray_stride):
        dx, dy = COS[k] * step, SIN[k] * step
        for j in range(first, last + 1, stride):
            px, py = x0 + dx * np.float32(j), y0 + dy * np.float32(j)
            place = np.float32(sqrt(px * px + py * py)) * scale
            index = int(place)
            if index < N_PROFILE - 1:
                part = place - np.float32(index)
                polar[k, j] += profile[index] + part * (profile[index + 1] - profile[index])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def fall(polar: Polar, k: int, j: int, stride: int) -> float:
    """How much brightness falls across step `j`, smoothed; NaN where a sample is outside the frame."""
    inside = polar[k, j - stride] + np.float32(0.5) * polar[k, j - 2 * stride]
    outside = polar[k, j + stride] + np.float32(0.5) * polar[k, j + 2 * stride]
    return float((inside - outside) * np.float32(1.0 / 1.5))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def find_edges(
    polar: Polar, reach: float, first: int, last: int, stride: int, ray_stride: int, edge: Column, drop: Column
) -> None:
    """Where each ray falls fastest near distance 1: `edge` in radii and `drop`, the fall there (0 where it has none).

    An edge `reach` radii off the circle must be 1.5 times as strong as one on it.
    """
    for k in range(N_RAYS):
        drop[k] = 0.0
    for k in range(0, N_RAYS, ray_stride):
        best, best_j = 0.0, -1
        for j in range(first, last + 1, stride):
            away = (j * STEP - 1.0) / reach
            value = fall(polar, k, j, stride) / (1.0 + 0.5 * away * away)
            if value > best:
                best, best_j = value, j
        if best_j < 0:
            continue
        here = fall(polar, k, best_j, stride)
        shift = 0.0
        if first < best_j < last:
            before, after = fall(polar, k, best_j - stride, stride), fall(polar, k, best_j + stride, stride)
            bend = before - 2.0 * here + after
            if bend < 0.0:
                shift = min(max(0.5 * (before - after) / bend, -0.5), 0.5)
        edge[k], drop[k] = (best_j + shift * stride) * STEP, here


@numba.njit(cache=True, nogil=True, error_model="numpy")
def fit_circle(edge: Column, drop: Column, circle: Column, weight: Column) -> float:
    """Circle through the edges, robust against some that belong to something else.

    `circle` receives the shift in x and y and the radius, all in old radii; `weight` how far each edge is believed.
    Returns the spread of the edges around the circle, NaN where fewer than 6 rays have an edge.
    """
    total, n_edges = 0.0, 0
    for k in range(N_RAYS):
        if drop[k] > 0.0:
            total += drop[k]
            n_edges += 1
    if n_edges < _LEAST_EDGES:
        return np.nan
    typical = total / n_edges
    for k in range(N_RAYS):
        weight[k] = min(drop[k] / typical, 1.0)
    circle[0], circle[1], circle[2] = 0.0, 0.0, 1.0
    spread = np.nan
    away = np.empty(N_RAYS)
    for step in range(4):
        if not _solve(edge, weight, circle):
            return np.nan
        n = 0
        for k in range(N_RAYS):
            if drop[k] > 0.0:
                away[n] = abs(edge[k] - (circle[2] + circle[0] * COS[k] + circle[1] * SIN[k]))
                n += 1
        spread = 1.4826 * _median(away, n)
        if step == 3:
            break
        limit = max(_OUTLIER_LEAST, 2.5 * spread)
        for k in range(N_RAYS):
            if drop[k] > 0.0:
                off = (edge[k] - (circle[2] + circle[0] * COS[k] + circle[1] * SIN[k])) / limit
                weight[k] = min(drop[k] / typical, 1.0) * max(1.0 - off * off, 0.0) ** 2
    return spread


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _median(values: Column, n: int) -> float:
    """Median of the first `n` of `values`, shape (N_RAYS,), by counting for each how many are smaller.

    That needs no branch on a comparison, and so takes a third of the time of sorting.
    """
    for i in range(n, N_RAYS):
        values[i] = np.inf
    lower = upper = 0.0
    for i in range(n):
        n_smaller = n_as_small = 0
        for j in range(N_RAYS):
            n_smaller += values[j] < values[i]
            n_as_small += values[j] <= values[i]
        if n_smaller <= (n - 1) // 2 < n_as_small:
            lower = values[i]
        if n_smaller <= n // 2 < n_as_small:
            upper = values[i]
    return float(0.5 * (lower + upper))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _solve(edge: Column, weight: Column, circle: Column) -> bool:
    """Weighted least squares of edge = radius + dx cos + dy sin."""
    s1 = sc = ss = scc = sss = scs = e1 = ec = es = 0.0
    for k in range(N_RAYS):
        w = weight[k]
        if w > 0.0:
            c, s, e = float(COS[k]), float(SIN[k]), edge[k]
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
    # A little against shifts: a short arc says nothing about the centre.
    scc += 1e-3 * s1
    sss += 1e-3 * s1
    a, b, d = scc - sc * sc / s1, scs - sc * ss / s1, sss - ss * ss / s1
    p, q = ec - sc * e1 / s1, es - ss * e1 / s1
    determinant = a * d - b * b
    if determinant <= 1e-9 * s1 * s1:
        return False
    circle[0] = (p * d - q * b) / determinant
    circle[1] = (q * a - p * b) / determinant
    circle[2] = (e1 - circle[0] * sc - circle[1] * ss) / s1
    return True
