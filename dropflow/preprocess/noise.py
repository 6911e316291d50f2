"""How noisy a frame is, measured on itself."""

from math import exp, sqrt

import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

QUANTILE = 0.25
"""The quietest part of the frame tells the noise, so that droplets may cover much of it."""
SIGMA_OVER_QUANTILE = 3.1383
"""Standard deviation of normal noise over that quantile of its absolute value."""
MAX_ROWS = 1000


def noise_std(image: Image, *, apart_px: float, blur_px: float) -> float:
    """Standard deviation of what was white noise before a blur, from how unlike neighbours along x are.

    A second difference, which takes no notice of slopes.

    Parameters
    ----------
    image
        Shape (rows, columns), float32. At most 1000 rows are looked at.
    apart_px
        Distance of the neighbours: less than droplets are wide.
    blur_px
        Sigma of the blur along x, after which neighbours are alike by ``exp(-d^2 / (4 sigma^2))``.

    Returns
    -------
    In the levels of `image`; 0 for a frame too narrow to tell.
    """
    apart = max(1, round(apart_px))
    rows = image[:: -(-image.shape[0] // MAX_ROWS)]
    second = np.abs(rows[:, : -2 * apart] - 2 * rows[:, apart:-apart] + rows[:, 2 * apart :])
    if second.size == 0:
        return 0.0
    alike, alike_twice = (exp(-((apart * steps / max(blur_px, 1e-3)) ** 2) / 4) for steps in (1, 2))
    return float(np.quantile(second, QUANTILE)) * SIGMA_OVER_QUANTILE / sqrt(6 - 8 * alike + 2 * alike_twice)
