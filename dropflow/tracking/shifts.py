"""Steps in which the camera moved: all droplets at once go elsewhere than before and after."""

import numpy as np

from dropflow.tracking.grid import Column

_N_BESIDE = 3
"""Steps before and after with which a step is compared."""
_LEAST_STEPS = 5
_MOST_DEVIATION = 8.0
"""Of the mean flow from that of the steps beside, in units of what is usual in the film."""
_LEAST_SHIFT_PX = 2.0
_NORMAL_MAD = 1.4826
"""Standard deviation of a normal variable over its median absolute deviation."""


def camera_shifts_px(velocity_um_s: Column, dt_s: Column, pixel_size_um: float) -> Column:
    """By how much the camera moved in each step, shape (n_steps, 2), px; zero where it did not.

    A flow changes from step to step by little and goes on changing; a push is in one step alone.

    Parameters
    ----------
    velocity_um_s : ndarray, float64, shape (n_steps, 2)
        Mean of the flow field of each step along x and y; NaN where it is not known.
    dt_s : ndarray, float64, shape (n_steps,)
    pixel_size_um : float
    """
    n_steps = len(velocity_um_s)
    shifts = np.zeros((n_steps, 2))
    if n_steps < _LEAST_STEPS:
        return shifts
    expected = np.full((n_steps, 2), np.nan)
    for step in range(n_steps):
        beside = np.delete(
            np.arange(max(step - _N_BESIDE, 0), min(step + _N_BESIDE + 1, n_steps)), min(step, _N_BESIDE)
        )
        known = velocity_um_s[beside][np.isfinite(velocity_um_s[beside, 0])]
        if len(known) > 1:
            expected[step] = np.median(known, axis=0)
    off_px = (velocity_um_s - expected) * dt_s[:, None] / pixel_size_um
    is_known = np.isfinite(off_px).all(axis=1)
    if not is_known.any():
        return shifts
    usual_px = _NORMAL_MAD * float(np.median(np.abs(off_px[is_known])))
    away_px = np.hypot(*np.nan_to_num(off_px).T)
    has_moved = is_known & (away_px > _LEAST_SHIFT_PX + _MOST_DEVIATION * usual_px)
    shifts[has_moved] = off_px[has_moved]
    return shifts
