"""Stripes: lines of light and shadow that droplets throw along the frame, measured on the background and taken away."""

from enum import StrEnum

import cv2
import numba
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

_BIN = 16
"""Pixels along a stripe that are averaged before the background is looked for."""
_WINDOW = 15
"""Bins (240 px) of which the lower part is taken for background: droplets fill less than two thirds of them."""
_STRIDE = 4
_QUANTILE = 0.35
_ACROSS_PX = 24.0
"""What changes more slowly than this across the stripes (standard deviation of a blur) is no stripe."""
_LEAST_SHARE = 0.4
"""Where less than this of what is found is stripes, they are left alone."""


class Stripes(StrEnum):
    """The direction in which a stack has stripes."""

    NONE = "none"
    ROWS = "rows"
    COLUMNS = "columns"


def stripe_strength(image: Image) -> float:
    """Standard deviation of what looks like stripes along the rows, in levels of `image`; 0 for small frames.

    Droplets alone look a little like stripes, but along columns as much as along rows.
    """
    ground = _ground(image)
    return 0.0 if ground is None else float(np.median(np.abs(ground))) / 0.6745


def direction_of(along_rows: float, along_columns: float) -> tuple[Stripes, float]:
    """Direction of the stripes, and the share of them in what is found there (the weaker direction has none)."""
    strong, weak = max(along_rows, along_columns), min(along_rows, along_columns)
    share = 1.0 - (weak / strong) ** 2 if strong > 0 else 0.0
    if share < _LEAST_SHARE:
        return Stripes.NONE, 0.0
    return (Stripes.ROWS if along_rows > along_columns else Stripes.COLUMNS), share


def remove_stripes(image: Image, stripes: Stripes, share: float) -> None:
    """Subtract this share of what looks like stripes, in place."""
    view = image.T if stripes is Stripes.COLUMNS else image
    ground = None if stripes is Stripes.NONE else _ground(view)
    if ground is None:
        return
    limit = 6 * float(np.median(np.abs(ground))) / 0.6745
    np.clip(ground, -limit, limit, out=ground)
    ground *= np.float32(share)
    # Centres of windows are _STRIDE * _BIN px apart; beyond the first and last the stripe goes on as it is.
    at = (np.arange(view.shape[1]) - (_WINDOW * _BIN - 1) / 2) / (_STRIDE * _BIN)
    _subtract(view, ground, np.clip(at, 0, ground.shape[1] - 1).astype(np.float32))


def _ground(image: Image) -> Image | None:
    """Background along rows without what changes slowly across them, shape (rows, windows); None for small frames.

    In windows along a row that are far longer than a droplet is wide, a low quantile is the background.
    """
    rows, columns = image.shape
    n_bins = columns // _BIN
    if n_bins < _WINDOW or rows < 4 * _ACROSS_PX:
        return None
    whole = np.ascontiguousarray(image[:, : n_bins * _BIN])
    binned = cv2.resize(whole, (n_bins, rows), interpolation=cv2.INTER_AREA)
    ground = _low_quantiles(binned)
    slow = cv2.GaussianBlur(ground, (0, 0), sigmaX=0.01, sigmaY=_ACROSS_PX, borderType=cv2.BORDER_REFLECT)
    result: Image = ground - slow
    return result


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _low_quantiles(binned: Image) -> Image:
    rows, n_bins = binned.shape
    n_windows = (n_bins - _WINDOW) // _STRIDE + 1
    rank = int(_QUANTILE * (_WINDOW - 1))
    result = np.empty((rows, n_windows), np.float32)
    window = np.empty(_WINDOW, np.float32)
    for row in range(rows):
        for k in range(n_windows):
            for i in range(_WINDOW):
                value = binned[row, k * _STRIDE + i]
                j = i - 1
                while j >= 0 and window[j] > value:
                    window[j + 1] = window[j]
                    j -= 1
                window[j + 1] = value
            result[row, k] = window[rank]
    return result


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _subtract(image: Image, ground: Image, at: npt.NDArray[np.float32]) -> None:
    """Subtract `ground`, linear between its columns, which `at` gives for each column of the image."""
    n = ground.shape[1]
    for row in range(image.shape[0]):
        for column in range(at.size):
            k = int(at[column])
            part = at[column] - np.float32(k)
            image[row, column] -= ground[row, k] + part * (ground[row, min(k + 1, n - 1)] - ground[row, k])
