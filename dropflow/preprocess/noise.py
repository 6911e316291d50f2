"""How noisy a frame is, measured on itself."""

from math import exp, sqrt

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

QUANTILE = 0.25
"""The quietest part of the frame tells the noise, so that droplets may cover much of it."""
SIGMA_OVER_QUANTILE = 3.1383
"""Standard deviation of normal noise over that quantile of its absolute value."""
MAX_ROWS = 1000

_KERNEL = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32) / 6
"""The difference of two Laplacians: no slope and no edge along x or y passes it, white noise keeps its sigma."""
_N_TILES = 8
_TILE_PX = 32
_LEAST_SHARE = 2e-3
"""Noise is at least this part of the range of levels: images without any are quantised, or made by a computer."""


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


def noise_level(image: Image) -> float:
    """Standard deviation of one pixel's noise, in the image's own levels.

    The median over tiles spread over the frame, each by the median absolute value of a filter that edges do not pass
    (Immerkaer, 1996, DOI 10.1006/cviu.1996.0060). Tiles take 1 ms where the whole frame would take 50.
    """
    rows, columns = image.shape
    if min(rows, columns) < 3:
        return 1.0
    tile_rows, tile_columns = min(_TILE_PX, rows), min(_TILE_PX, columns)
    found = []
    for top in np.linspace(0, rows - tile_rows, _N_TILES).astype(int):
        for left in np.linspace(0, columns - tile_columns, _N_TILES).astype(int):
            tile = image[top : top + tile_rows, left : left + tile_columns]
            passed = cv2.filter2D(tile, -1, _KERNEL)[1:-1, 1:-1]
            found.append(float(np.median(np.abs(passed))))
    low, high = np.percentile(image[::8, ::8], [1, 99])
    noise = float(np.median(found)) / 0.6745
    return max(noise, _LEAST_SHARE * float(high - low), float(np.finfo(np.float32).tiny))
