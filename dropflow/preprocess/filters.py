"""Gaussian filters given as widths in Fourier index, done in real space."""

from math import pi, sqrt

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

REDUCED_SIGMA = 4.0
"""A blur is done on a frame reduced until its sigma is about this many pixels: wide ones cost as little as narrow ones."""


def band_pass(image: Image, *, high_pass_x: float, high_pass_y: float, low_pass: float) -> Image:
    """Remove stripes along x and noise (section 3.1.1).

    Multiplying the spectrum by ``1 - exp(-u^2 / (2 high_pass_x^2) - v^2 / (2 high_pass_y^2))`` and by
    ``exp(-(u^2 + v^2) / (2 low_pass^2))``, with Fourier indices u along x and v along y, is subtracting one Gaussian
    blur from another, with sigma = side / (2 pi width). In real space that costs a tenth and reflects the frame at its
    borders instead of wrapping it around.

    Parameters
    ----------
    image
        Shape (rows, columns), float32; it is left as it is.
    high_pass_x, high_pass_y, low_pass
        Widths in Fourier index; the paper's are 5, 200 and 100.

    Returns
    -------
    Shape (rows, columns), float32, around zero.
    """
    rows, columns = image.shape
    low_x, low_y = columns / (2 * pi * low_pass), rows / (2 * pi * low_pass)
    wide_x, wide_y = columns / (2 * pi * high_pass_x), rows / (2 * pi * high_pass_y)
    stripes = smooth(image, sqrt(wide_x**2 + low_x**2), sqrt(wide_y**2 + low_y**2))
    filtered = smooth(image, low_x, low_y)
    filtered -= stripes
    return filtered


def smooth(image: Image, sigma_x: float, sigma_y: float) -> Image:
    """Blur with a Gaussian of `sigma_x`, `sigma_y` px, borders reflected; shape (rows, columns), float32 as `image`.

    The frame is averaged down, blurred and interpolated back, and the blur that this adds by itself is taken off.
    """
    rows, columns = image.shape
    small_columns, rest_x = _reduction(columns, sigma_x)
    small_rows, rest_y = _reduction(rows, sigma_y)
    small = cv2.resize(image, (small_columns, small_rows), interpolation=cv2.INTER_AREA)
    cv2.GaussianBlur(small, (0, 0), sigmaX=rest_x, sigmaY=rest_y, dst=small, borderType=cv2.BORDER_REFLECT)
    blurred: Image = cv2.resize(small, (columns, rows), interpolation=cv2.INTER_LINEAR)
    return blurred


def _reduction(side: int, sigma: float) -> tuple[int, float]:
    """Reduced length of a side, and the sigma still to do there in its own (larger) pixels."""
    small_side = max(1, round(side / max(1.0, sigma / REDUCED_SIGMA)))
    factor = side / small_side
    if factor == 1:
        return side, sigma
    # A box of `factor` px has variance (f^2 - 1) / 12, the triangle of the interpolation back (f^2 - 1) / 6.
    own_variance = (factor**2 - 1) / 4
    return small_side, sqrt(max(sigma**2 - own_variance, 0.01)) / factor
