"""What tells a droplet from everything else: numbers without units of length or brightness.

Brightness is measured in noise, in the candidate's own edge, or in the frame's usual edge, never in grey levels, and
lengths in the candidate's own radius: what was learnt on one camera holds on the next.
"""

from math import log, sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.rays import COS, N_PROFILE, N_RAYS, N_STEPS, RIM, SIN, fall

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

_PROFILE_AT = (0, 3, 6, 8, 10, 12, 13, 15, 16, 17, 19, 20, 22, 24, 27)
"""Steps at which the mean profile is a feature of its own."""
FEATURES = (
    "log_r_px",  # ln of the radius in pixels of the frame
    "inside",  # share of rays inside the frame
    "spread",  # of edges around the circle
    "edge_share",  # rays with an edge on the circle
    "edge_noise",  # ln of the edge over the noise
    "contrast_noise",  # ln of the contrast over the noise
    "sharpness",  # edge over contrast
    "weakest_arc",  # edge of the weakest of all arcs of 5 rays, over the mean edge
    "weakest_quarter",  # mean of the weakest quarter of rays, over the mean edge
    "strong_share",  # rays with at least half of the mean edge
    "noisy_share",  # rays with an edge of at least three noises
    "edge_variation",
    "ring_variation",  # of the brightness outside, around the droplet, over the edge
    "disk_variation",  # of the brightness inside
    "width",  # distance in which the profile falls from 3/4 to 1/4
    "skew",  # of that fall
    "middle",  # where it has fallen to half
    "dip",  # centre minus 0.6 radii, over the edge
    "ring_slope",  # first harmonic of the brightness around the droplet, over the edge
    "match",  # share of the variance around the place that its mean radial profile explains
    "ring_level",  # brightness around the droplet above the background, over the frame's usual edge
    "edge_usual",  # ln of the edge over the frame's usual one
    "contrast_usual",  # contrast over the frame's usual one
    *(f"profile_{at}" for at in _PROFILE_AT),
    "votes",  # of the candidate, over those of a whole outline
    "frame_edge",  # ln of the frame's usual edge over its noise
    "frame_dip",  # usual centre minus 0.6 radii, over the edge: whether this frame's droplets have rims
    "frame_sharpness",  # usual edge over contrast
)
N_FEATURES = len(FEATURES)
(
    LOG_R,
    INSIDE,
    SPREAD,
    EDGE_SHARE,
    EDGE_NOISE,
    CONTRAST_NOISE,
    SHARPNESS,
    WEAKEST_ARC,
    WEAKEST_QUARTER,
    STRONG_SHARE,
    NOISY_SHARE,
    EDGE_VARIATION,
    RING_VARIATION,
    DISK_VARIATION,
    WIDTH,
    SKEW,
    MIDDLE,
    DIP,
    RING_SLOPE,
    MATCH,
    RING_LEVEL,
    EDGE_USUAL,
    CONTRAST_USUAL,
    FIRST_PROFILE,
) = range(24)
VOTES, FRAME_EDGE, FRAME_DIP, FRAME_SHARPNESS = range(N_FEATURES - 4, N_FEATURES)
_LEAST_RAYS = 8
_REORDERED = {"reassoc", "nsz", "arcp", "contract"}
"""Sums may be reordered. With loops that run along whole rays, of a length the compiler knows, they become vector
instructions; brightness is taken from that of the centre, or float32 would not hold its squares."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def measure(
    polar: Polar, edge: Column, drop: Column, weight: Column, spread: float, r_px: float, noise: float, row: Column
) -> None:
    """Fill `row`, shape (N_FEATURES,), for a circle with these samples and edges; it stays NaN where nothing is seen.

    `noise` is that of a pixel of the level looked at. Levels are left in grey levels, for
    `relate_to_frame` to finish.
    """
    rim = np.empty(N_RAYS)
    n_inside = _rim_falls(polar, rim)
    if n_inside < _LEAST_RAYS:
        return
    typical = _mean_edge(drop, weight, rim)
    if not typical > 0.0:
        return
    profile = np.empty(N_STEPS)
    _mean_profile(polar, weight, profile)
    row[LOG_R] = log(r_px)
    row[INSIDE] = n_inside / N_RAYS
    row[SPREAD] = spread
    row[EDGE_SHARE] = _share_on_circle(edge, drop, rim) / n_inside
    _edge_features(rim, n_inside, typical, noise, row)
    _profile_features(profile, typical, noise, row)
    _around(polar, typical, row)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _rim_falls(polar: Polar, rim: Column) -> int:
    """Fall of each ray at the circle, NaN for rays that leave the frame before 1.25 radii; returns how many do not."""
    n_inside = 0
    for k in range(N_RAYS):
        rim[k] = np.nan
        if polar[k, RIM + 4] == polar[k, RIM + 4]:
            rim[k] = (fall(polar, k, RIM - 1, 1) + fall(polar, k, RIM, 1) + fall(polar, k, RIM + 1, 1)) / 3.0
            n_inside += 1
    return n_inside


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _mean_edge(drop: Column, weight: Column, rim: Column) -> float:
    total = total_weight = 0.0
    for k in range(N_RAYS):
        if rim[k] == rim[k] and weight[k] > 0.0:
            total += weight[k] * drop[k]
            total_weight += weight[k]
        else:
            weight[k] = 0.0
    return total / total_weight if total_weight > 0.0 else 0.0


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REORDERED)
def _mean_profile(polar: Polar, weight: Column, profile: Column) -> None:
    """Brightness by distance, averaged over rays by weight; a step without any ray repeats the one before."""
    total, total_weight = np.zeros(N_STEPS, np.float32), np.zeros(N_STEPS, np.float32)
    ground = polar[0, 0] if polar[0, 0] == polar[0, 0] else np.float32(0)
    for k in range(N_RAYS):
        believed = np.float32(weight[k])
        if believed <= 0:
            continue
        for j in range(N_STEPS):
            level = polar[k, j] - ground
            is_inside = level == level
            total[j] += believed * level if is_inside else np.float32(0)
            total_weight[j] += believed if is_inside else np.float32(0)
    for j in range(N_STEPS):
        is_seen = total_weight[j] > 0
        profile[j] = float(ground) + total[j] / total_weight[j] if is_seen else profile[max(j - 1, 0)]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _share_on_circle(edge: Column, drop: Column, rim: Column) -> int:
    n = 0
    for k in range(N_RAYS):
        if rim[k] == rim[k] and drop[k] > 0.0 and abs(edge[k] - 1.0) < 0.12:
            n += 1
    return n


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _edge_features(rim: Column, n_inside: int, typical: float, noise: float, row: Column) -> None:
    """How strong and how even the edge is around the droplet."""
    row[EDGE_NOISE] = log(typical / noise)
    weakest = np.inf
    n_strong = n_noisy = 0
    total = total_square = 0.0
    sorted_rim = np.empty(n_inside)
    n = 0
    for k in range(N_RAYS):
        value = rim[k]
        if value != value:
            continue
        sorted_rim[n] = value
        n += 1
        n_strong += value > 0.5 * typical
        n_noisy += value > 3.0 * noise
        total += value
        total_square += value * value
        arc, n_arc = 0.0, 0
        for step in range(-2, 3):
            neighbour = rim[(k + step) % N_RAYS]
            if neighbour == neighbour:
                arc += neighbour
                n_arc += 1
        if n_arc >= 3:
            weakest = min(weakest, arc / n_arc)
    sorted_rim.sort()
    mean = total / n_inside
    row[WEAKEST_ARC] = weakest / typical
    row[WEAKEST_QUARTER] = np.mean(sorted_rim[: max(n_inside // 4, 1)]) / typical
    row[STRONG_SHARE] = n_strong / n_inside
    row[NOISY_SHARE] = n_noisy / n_inside
    row[EDGE_VARIATION] = sqrt(max(total_square / n_inside - mean * mean, 0.0)) / typical


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _profile_features(profile: Column, typical: float, noise: float, row: Column) -> None:
    """Contrast, the shape of the fall, the levels that are later related to the frame, and the profile itself."""
    inner, outer = float(np.mean(profile[:11])), float(np.mean(profile[20:27]))
    contrast = float(inner - outer)
    row[CONTRAST_NOISE] = log(max(contrast / noise, 1e-2))
    row[SHARPNESS] = typical / max(contrast, noise)
    top, bottom = max(profile[9], profile[10]), min(profile[21], profile[24])
    upper, half = _crossing(profile, top, bottom, 0.75), _crossing(profile, top, bottom, 0.5)
    lower = _crossing(profile, top, bottom, 0.25)
    row[WIDTH] = lower - upper
    row[SKEW] = lower + upper - 2.0 * half
    row[MIDDLE] = half
    row[DIP] = (profile[0] - profile[10]) / typical
    row[RING_LEVEL], row[EDGE_USUAL], row[CONTRAST_USUAL] = outer, typical, contrast
    for n, at in enumerate(_PROFILE_AT):
        row[FIRST_PROFILE + n] = (profile[at] - outer) / typical


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _crossing(profile: Column, top: float, bottom: float, share: float) -> float:
    """Distance in radii at which the profile first falls below this share of the way from bottom to top."""
    level = bottom + (top - bottom) * share
    for j in range(6, N_PROFILE):
        if profile[j] >= level > profile[j + 1]:
            return float((j + (profile[j] - level) / (profile[j] - profile[j + 1])) / RIM)
    return np.nan


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _around(polar: Polar, typical: float, row: Column) -> None:
    """How even it is around the droplet and in it, and how round all of it."""
    row[RING_VARIATION] = _variation(polar, 20) / typical
    row[DISK_VARIATION] = _variation(polar, 9) / typical
    along_x = along_y = mean = 0.0
    n = 0
    for k in range(N_RAYS):
        level = polar[k, 21]
        if level == level:
            mean += level
            n += 1
    mean /= max(n, 1)
    for k in range(N_RAYS):
        level = polar[k, 21]
        if level == level:
            along_x += (level - mean) * COS[k]
            along_y += (level - mean) * SIN[k]
    row[RING_SLOPE] = sqrt(along_x * along_x + along_y * along_y) / max(n, 1) / typical
    row[MATCH] = _explained(polar)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _variation(polar: Polar, first: int) -> float:
    """Standard deviation around the droplet of the mean over three steps from `first`."""
    total = total_square = 0.0
    n = 0
    for k in range(N_RAYS):
        level = (polar[k, first] + polar[k, first + 1] + polar[k, first + 2]) / 3.0
        if level == level:
            total += level
            total_square += level * level
            n += 1
    if n == 0:
        return np.nan
    mean = total / n
    return sqrt(max(total_square / n - mean * mean, 0.0))


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REORDERED)
def _explained(polar: Polar) -> float:
    """Share of the variance over the disk of 1.4 radii that is a function of distance alone."""
    ring, square = np.zeros(N_STEPS, np.float32), np.zeros(N_STEPS, np.float32)
    n_inside = np.zeros(N_STEPS, np.float32)
    ground = polar[0, 0] if polar[0, 0] == polar[0, 0] else np.float32(0)
    for k in range(N_RAYS):
        for j in range(N_STEPS):
            level = polar[k, j] - ground
            is_inside = level == level
            ring[j] += level if is_inside else np.float32(0)
            square[j] += level * level if is_inside else np.float32(0)
            n_inside[j] += np.float32(1) if is_inside else np.float32(0)
    total = total_square = weights = within = 0.0
    for j in range(2, 23, 2):
        if n_inside[j] > 0:
            weight = j / n_inside[j]
            total += weight * ring[j]
            total_square += weight * square[j]
            weights += j
            within += weight * (square[j] - ring[j] * ring[j] / n_inside[j])
    variance = total_square - total * total / max(weights, 1e-30)
    return 1.0 - within / variance if variance > 0.0 else 0.0
