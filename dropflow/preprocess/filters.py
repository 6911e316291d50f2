"""Gaussian filters, done in real space."""

from dataclasses import dataclass
from math import hypot, pi, sqrt

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

REDUCED_SIGMA = 4.0
"""A blur is done on a frame reduced until its sigma is about this many pixels: a wide one costs no more."""


@dataclass(frozen=True)
class Blur:
    """Standard deviations of a Gaussian blur, px."""

    sigma_x: float
    sigma_y: float

    @staticmethod
    def from_fourier(shape: tuple[int, int], index_x: float, index_y: float) -> "Blur":
        """The blur that multiplies the spectrum of a frame by ``exp(-u^2 / (2 index_x^2) - v^2 / (2 index_y^2))``.

        u and v are Fourier indices (waves per side) along x and y: sigma = side / (2 pi index).
        """
        rows, columns = shape
        return Blur(columns / (2 * pi * index_x), rows / (2 * pi * index_y))

    def after(self, other: "Blur") -> "Blur":
        """Both blurs, one after the other."""
        return Blur(hypot(self.sigma_x, other.sigma_x), hypot(self.sigma_y, other.sigma_y))


def band_pass(image: Image, *, high_pass: Blur, low_pass: Blur) -> Image:
    """Subtract what `high_pass` leaves of a frame, and blur the rest by `low_pass` (section 3.1.1).

    That is a filter ``(1 - H) L`` with two Gaussians H and L of the spectrum. In real space it costs a tenth, and it
    reflects the frame at its borders instead of wrapping it around.

    Parameters
    ----------
    image
        Shape (rows, columns), float32; it is left as it is.
    high_pass, low_pass
        The two blurs.

    Returns
    -------
    Shape (rows, columns), float32, around zero.
    """
    filtered = smooth(image, low_pass)
    filtered -= smooth(image, high_pass.after(low_pass))
    return filtered


def smooth(image: Image, blur: Blur) -> Image:
    """Blur with a Gaussian, borders reflected; shape (rows, columns), float32 as `image`.

    The frame is averaged down, blurred and interpolated back, and the blur that this adds by itself is taken off.
    """
    rows, columns = image.shape
    small_columns, rest_x = _reduction(columns, blur.sigma_x)
    small_rows, rest_y = _reduction(rows, blur.sigma_y)
    small = cv2.resize(image, (small_columns, small_rows), interpolation=cv2.INTER_AREA)
    blurred = cv2.GaussianBlur(small, (0, 0), sigmaX=rest_x, sigmaY=rest_y, borderType=cv2.BORDER_REFLECT)
    return np.asarray(cv2.resize(blurred, (columns, rows), interpolation=cv2.INTER_LINEAR), np.float32)


def _reduction(side: int, sigma: float) -> tuple[int, float]:
    """Reduced length of a side, and the sigma still to do there in its own (larger) pixels."""
    small_side = max(1, round(side / max(1.0, sigma / REDUCED_SIGMA)))
    factor = side / small_side
    if factor == 1:
        return side, sigma
    # A box of `factor` px has variance (f^2 - 1) / 12, the triangle of the interpolation back (f^2 - 1) / 6.
    own_variance = (factor**2 - 1) / 4
    return small_side, sqrt(max(sigma**2 - own_variance, 0.01)) / factor
