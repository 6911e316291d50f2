"""Droplets that are sure explain a part of the image: it is taken away, and what is left is looked at again.

Light of overlapping droplets adds up. A droplet's own part is its median over directions, which a neighbour that covers
less than half of its outline does not change.
"""

from math import ceil, floor, sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.rays import N_PROFILE, N_RAYS, N_STEPS, STEP, sample

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

_QUANTILE = 0.4
"""Light of neighbours only adds: a little below the median is nearer to the droplet's own part."""
_EDGE_FROM = 14
"""From this step outwards a droplet's own light only falls."""
_OUTSIDE_FROM = 19
_OUTSIDE = np.float32(np.inf)
"""Stands for samples outside the frame: behind all others."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def own_profile(image: Image, x: float, y: float, r: float, polar: Polar, profile: Polar) -> None:
    """The droplet's own brightness above its surroundings by distance, shape (N_PROFILE,), steps of STEP radii."""
    sample(image, x, y, r, 0, N_PROFILE - 1, 1, 1, polar)
    n_inside = np.zeros(N_PROFILE, np.int64)
    for k in range(N_RAYS):
        for j in range(N_PROFILE):
            if polar[k, j] == polar[k, j]:
                n_inside[j] += 1
            else:
                polar[k, j] = _OUTSIDE
    _lowest_first(polar)
    for j in range(N_PROFILE):
        n = n_inside[j]
        profile[j] = polar[int(_QUANTILE * (n - 1)), j] if n > 0 else profile[max(j - 1, 0)]
    end = _OUTSIDE_FROM
    for j in range(_OUTSIDE_FROM, N_PROFILE):
        if profile[j] < profile[end]:
            end = j
    ground = profile[end]
    for j in range(N_PROFILE):
        profile[j] = max(profile[j] - ground, np.float32(0)) if j < end else np.float32(0)
        if j >= _EDGE_FROM:
            profile[j] = min(profile[j], profile[j - 1])


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"nnan", "nsz"})
def _lowest_first(polar: Polar) -> None:
    """Sort each step over the rays as far as the quantile: all steps at once, by vector instructions."""
    for place in range(int(_QUANTILE * (N_RAYS - 1)) + 1):
        for k in range(N_RAYS - 1, place, -1):
            for j in range(N_STEPS):
                above, below = polar[k - 1, j], polar[k, j]
                polar[k - 1, j], polar[k, j] = (above, below) if above < below else (below, above)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def subtract(image: Image, x: float, y: float, r: float, profile: Polar) -> None:
    """Take a droplet with this profile out of `image`, in place."""
    rows, columns = image.shape
    reach = r * STEP * (N_PROFILE - 1)
    for n in range(N_PROFILE):
        if profile[n] == 0.0:
            reach = r * STEP * n
            break
    scale = np.float32(1.0 / (r * STEP))
    for row in range(max(0, ceil(y - reach)), min(rows - 1, floor(y + reach)) + 1):
        dy = np.float32(row - y)
        half = sqrt(max(reach * reach - float(dy * dy), 0.0))
        for column in range(max(0, ceil(x - half)), min(columns - 1, floor(x + half)) + 1):
            dx = np.float32(column - x)
            place = np.float32(sqrt(dx * dx + dy * dy)) * scale
            index = min(int(place), N_PROFILE - 2)
            part = place - np.float32(index)
            image[row, column] -= profile[index] + part * (profile[index + 1] - profile[index])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def explain_away(image: Image, x: Column, y: Column, r: Column, profiles: Polar) -> None:
    """Measure the profiles of n droplets, shape (n, N_PROFILE), and take them out of `image` one after another.

    In the order given, the surest first: each is measured on what those before it have left.
    """
    polar = np.zeros((N_RAYS, N_STEPS), np.float32)
    for i in range(x.size):
        own_profile(image, x[i], y[i], r[i], polar, profiles[i])
        subtract(image, x[i], y[i], r[i], profiles[i])
