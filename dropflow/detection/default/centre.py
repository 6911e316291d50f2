"""Where exactly a droplet's centre is: the shift that makes its brightness a function of distance alone."""

from math import sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.rays import COS, N_RAYS, N_STEPS, SIN, STEP

Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

_N_TAKING_PART = 24
"""Samples up to 1.44 radii."""
_REORDERED = {"reassoc", "nsz", "arcp", "contract"}
"""Sums may be reordered. With loops that run along whole rays, of a length the compiler knows, they become vector
instructions."""
_DISTANCE = np.array([j * STEP for j in range(N_STEPS)], np.float32)
_N_ROUNDS = 3
_OUTLIERS = 2.0
"""Samples more than this many standard deviations off count less."""
_MOST_SHIFT = 0.2
_DISTURBED = 1.3
"""Where what the fit leaves over is this many times the noise, edges are believed as much as the disk."""


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REORDERED)
def better_shift(polar: Polar, weight: Column, noise: float, shift: Column) -> None:
    """Improve the shift of the centre in x and y, in radii, that the edges gave; in place.

    With the mean profile P(d) over rays, brightness on ray theta is P(d) - P'(d) (dx cos + dy sin) + d (a cos + b sin):
    a shift, and a slope of the ground under the droplet. The four are found by least squares over the whole disk, each
    sample counting by the area it stands for, those that something else disturbs less. This uses every pixel of a
    droplet, where edges use its outline only: three times as exact for one that is alone, but worse beside others whose
    light is not wholly explained. How much is left over beside the noise says which of the two to believe.
    """
    level, share = np.empty((N_RAYS, N_STEPS), np.float32), np.empty((N_RAYS, N_STEPS), np.float32)
    n_samples = _taking_part(polar, weight, level, share)
    if n_samples < 4 * N_RAYS:
        return
    profile, slope = np.zeros(N_STEPS, np.float32), np.zeros(N_STEPS, np.float32)
    dx = dy = a = b = 0.0
    scale = np.inf
    for step in range(_N_ROUNDS):
        _robust_profile(level, share, profile, slope, dx, dy, a, b)
        for j in range(1, _N_TAKING_PART - 1):
            slope[j] = (profile[j + 1] - profile[j - 1]) * np.float32(0.5 / STEP)
        slope[_N_TAKING_PART - 1] = slope[_N_TAKING_PART - 2]
        # No limit to what a sample may be off in the first round.
        limit = np.float32(_OUTLIERS * scale if step > 0 else 1e30)
        ss = sd = dd = xs = xd = ys = yd = total = 0.0
        for k in range(N_RAYS):
            if weight[k] <= 0.0:
                continue
            moved, tilted = np.float32(dx * COS[k] + dy * SIN[k]), np.float32(a * COS[k] + b * SIN[k])
            ray_ss = ray_sd = ray_dd = ray_rs = ray_rd = missed = np.float32(0)
            for j in range(N_STEPS):
                d, g = _DISTANCE[j], slope[j]
                rest = level[k, j] - profile[j]
                miss = abs(rest + g * moved - d * tilted)
                w = share[k, j]
                missed += miss if w > 0 else np.float32(0)
                w *= d * (limit / miss if miss > limit else np.float32(1))
                ray_ss += w * g * g
                ray_sd -= w * g * d
                ray_dd += w * d * d
                ray_rs -= w * rest * g
                ray_rd += w * rest * d
            total += float(missed)
            ss += float(ray_ss)
            sd += float(ray_sd)
            dd += float(ray_dd)
            xs += ray_rs * COS[k]
            xd += ray_rd * COS[k]
            ys += ray_rs * SIN[k]
            yd += ray_rd * SIN[k]
        scale = max(1.25 * total / n_samples, noise)
        # cos^2 and sin^2 are half on average; rays that leave the frame tilt this a little, rounds take it back.
        determinant = 0.25 * (ss * dd - sd * sd)
        if determinant <= 1e-9 * ss * dd:
            return
        dx, a = 0.5 * (xs * dd - xd * sd) / determinant, 0.5 * (xd * ss - xs * sd) / determinant
        dy, b = 0.5 * (ys * dd - yd * sd) / determinant, 0.5 * (yd * ss - ys * sd) / determinant
    if sqrt(dx * dx + dy * dy) <= _MOST_SHIFT:
        belief = 1.0 / (1.0 + (scale / (_DISTURBED * noise)) ** 4)
        shift[0] += belief * (dx - shift[0])
        shift[1] += belief * (dy - shift[1])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _taking_part(polar: Polar, weight: Column, level: Polar, share: Polar) -> int:
    """Fill `level` with brightness above the centre's and `share` with how far each sample counts; returns how many do.

    Brightness is taken from that of the centre, or float32 would not hold its sums.
    """
    n_samples = 0
    ground = polar[0, 0] if polar[0, 0] == polar[0, 0] else np.float32(0)
    for k in range(N_RAYS):
        believed = np.float32(max(weight[k], 0.0))
        is_whole = polar[k, _N_TAKING_PART - 1] == polar[k, _N_TAKING_PART - 1]
        n_samples += _N_TAKING_PART - 1 if is_whole and believed > 0 else 0
        for j in range(N_STEPS):
            level[k, j] = polar[k, j] - ground
            share[k, j] = believed if j < _N_TAKING_PART else np.float32(0)
        if is_whole:
            continue
        for j in range(N_STEPS):
            if level[k, j] != level[k, j]:
                level[k, j] = share[k, j] = np.float32(0)
            elif 0 < j < _N_TAKING_PART and believed > 0:
                n_samples += 1
    return n_samples


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_REORDERED)
def _robust_profile(
    level: Polar, share: Polar, profile: Polar, slope: Polar, dx: float, dy: float, a: float, b: float
) -> None:
    """Mean over rays, by share, of brightness less what shift and slope make of it."""
    total, total_share = np.zeros(N_STEPS, np.float32), np.zeros(N_STEPS, np.float32)
    for k in range(N_RAYS):
        moved, tilted = np.float32(dx * COS[k] + dy * SIN[k]), np.float32(a * COS[k] + b * SIN[k])
        for j in range(N_STEPS):
            total[j] += share[k, j] * (level[k, j] + slope[j] * moved - _DISTANCE[j] * tilted)
            total_share[j] += share[k, j]
    for j in range(_N_TAKING_PART):
        profile[j] = total[j] / total_share[j] if total_share[j] > 0 else profile[max(j - 1, 0)]
