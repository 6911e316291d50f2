"""Where exactly a droplet's centre is: the shift that makes its brightness a function of distance alone."""

from math import sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.rays import COS, N_RAYS, N_STEPS, SIN, STEP

Column = npt.NDArray[np.float64]
Polar = npt.NDArray[np.float32]

_LAST = 23
"""Samples up to 1.44 radii take part."""
_N_ROUNDS = 3
_OUTLIERS = 2.0
"""Samples more than this many standard deviations off count less."""
_MOST_SHIFT = 0.2
_DISTURBED = 1.3
"""Where what the fit leaves over is this many times the noise, edges are believed as much as the disk."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def better_shift(polar: Polar, weight: Column, noise: float, shift: Column) -> None:
    """Improve the shift of the centre in x and y, in radii, that the edges gave; in place.

    With the mean profile P(d) over rays, brightness on ray theta is P(d) - P'(d) (dx cos + dy sin) + d (a cos + b sin):
    a shift, and a slope of the ground under the droplet. The four are found by least squares over the whole disk, each
    sample counting by the area it stands for, those that something else disturbs less. This uses every pixel of a
    droplet, where edges use its outline only: three times as exact for one that is alone, but worse beside others whose
    light is not wholly explained. How much is left over beside the noise says which of the two to believe.
    """
    profile, slope = np.zeros(N_STEPS), np.zeros(N_STEPS)
    dx = dy = a = b = 0.0
    scale = np.inf
    for step in range(_N_ROUNDS):
        _robust_profile(polar, weight, profile, dx, dy, a, b, slope)
        for j in range(1, _LAST):
            slope[j] = (profile[j + 1] - profile[j - 1]) * (0.5 / STEP)
        slope[0], slope[_LAST] = 0.0, slope[_LAST - 1]
        ss = sd = dd = xs = xd = ys = yd = 0.0
        total, n = 0.0, 0
        for k in range(N_RAYS):
            if weight[k] <= 0.0:
                continue
            c, s = float(COS[k]), float(SIN[k])
            for j in range(1, _LAST + 1):
                level = polar[k, j]
                if level != level:
                    continue
                d = j * STEP
                rest = level - profile[j]
                model = -slope[j] * (dx * c + dy * s) + d * (a * c + b * s)
                miss = abs(rest - model)
                total += miss
                n += 1
                w = d * weight[k]
                if step > 0 and miss > _OUTLIERS * scale:
                    w *= _OUTLIERS * scale / miss
                ss += w * slope[j] * slope[j]
                sd -= w * slope[j] * d
                dd += w * d * d
                xs -= w * rest * slope[j] * c
                xd += w * rest * d * c
                ys -= w * rest * slope[j] * s
                yd += w * rest * d * s
        if n < 4 * N_RAYS:
            return
        scale = max(1.25 * total / n, noise)
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
def _robust_profile(
    polar: Polar, weight: Column, profile: Column, dx: float, dy: float, a: float, b: float, slope: Column
) -> None:
    """Mean over rays, by weight, of brightness less what shift and slope make of it."""
    for j in range(_LAST + 2):
        total = total_weight = 0.0
        for k in range(N_RAYS):
            level = polar[k, j]
            if weight[k] > 0.0 and level == level:
                turn = -slope[j] * (dx * COS[k] + dy * SIN[k]) + j * STEP * (a * COS[k] + b * SIN[k])
                total += weight[k] * (level - turn)
                total_weight += weight[k]
        profile[j] = total / total_weight if total_weight > 0.0 else profile[max(j - 1, 0)]
