"""Stripes: lines of light and shadow that droplets throw along the frame, measured on the background and taken away."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import cv2
import numba
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

_BIN = 24
"""Pixels along a stripe that are averaged before the background is looked for."""
_WINDOW = 10
"""Bins (240 px) of which the lower part is taken for background: droplets fill less than two thirds of them."""
_STRIDE = 4
_QUANTILE = 0.35
_ACROSS_PX = 24.0
"""What changes more slowly than this across the stripes (standard deviation of a blur) is no stripe."""
_LEAST_SHARE = 0.4
"""Where less than this of what is found is stripes, they are left alone."""
_LIMIT = 6.0
"""A stripe is at most this many standard deviations of all stripes strong."""


class Direction(StrEnum):
    """The direction in which a stack has stripes."""

    NONE = "none"
    ROWS = "rows"
    COLUMNS = "columns"


@dataclass(frozen=True)
class Stripes:
    """Stripes of a whole stack."""

    direction: Direction = Direction.NONE
    share: float = 0.0
    """Of what looks like stripes there, the part that is."""


NO_STRIPES = Stripes()


def measure_stripes(images: Sequence[Image]) -> Stripes:
    """Direction and share of the stripes in corrected frames of one stack, each of shape (rows, columns).

    Droplets look a little like stripes too, but along columns as much as along rows: only what one direction has more
    than the other is stripes.
    """
    if not images:
        return NO_STRIPES
    along_rows = float(np.median([strength(image) for image in images]))
    along_columns = float(np.median([strength(image.T) for image in images]))
    strong, weak = max(along_rows, along_columns), min(along_rows, along_columns)
    share = 1.0 - (weak / strong) ** 2 if strong > 0 else 0.0
    if share < _LEAST_SHARE:
        return NO_STRIPES
    return Stripes(Direction.ROWS if along_rows > along_columns else Direction.COLUMNS, share)


def remove_stripes(image: Image, stripes: Stripes) -> None:
    """Subtract the stripes that are found in `image`, in place.

    In windows along a stripe that are far longer than a droplet is wide, a low quantile is the background; what of it
    changes quickly across the stripes is them.
    """
    view = image.T if stripes.direction is Direction.COLUMNS else image
    ground = None if stripes.direction is Direction.NONE else _ground(view)
    if ground is None:
        return
    limit = _LIMIT * float(np.median(np.abs(ground))) / 0.6745
    np.clip(ground, -limit, limit, out=ground)
    ground *= np.float32(stripes.share)
    _subtract(view, ground)


def strength(image: Image) -> float:
    """Standard deviation of what looks like stripes along rows, in levels of `image`; 0 for small frames."""
    ground = _ground(image)
    return 0.0 if ground is None else float(np.median(np.abs(ground))) / 0.6745


def _ground(image: Image) -> Image | None:
    """Background along rows less what changes slowly across them, shape (rows, windows); None for small frames."""
    rows, columns = image.shape
    n_bins = columns // _BIN
    if n_bins < _WINDOW or rows < 4 * _ACROSS_PX:
        return None
    whole = np.ascontiguousarray(image[:, : n_bins * _BIN])
    binned = cv2.resize(whole, (n_bins, rows), interpolation=cv2.INTER_AREA)
    ground = _low_quantiles(np.asarray(binned, np.float32))
    slow = cv2.GaussianBlur(ground, (0, 0), sigmaX=0.01, sigmaY=_ACROSS_PX, borderType=cv2.BORDER_REFLECT)
    return np.asarray(ground - slow, np.float32)


def _low_quantiles(binned: Image) -> Image:
    """The low quantile of each window of bins, shape (rows, windows), for all rows at once."""
    rows, n_bins = binned.shape
    rank = int(_QUANTILE * (_WINDOW - 1))
    along = np.ascontiguousarray(binned.T)
    starts = range(0, n_bins - _WINDOW + 1, _STRIDE)
    result = np.empty((len(starts), rows), np.float32)
    for k, start in enumerate(starts):
        window = along[start : start + _WINDOW].copy()
        # The smallest values sink to the front, one after another, as far as the quantile.
        for place in range(rank + 1):
            for i in range(_WINDOW - 1, place, -1):
                smaller = np.minimum(window[i - 1], window[i])
                np.maximum(window[i - 1], window[i], out=window[i])
                window[i - 1] = smaller
        result[k] = window[rank]
    return np.ascontiguousarray(result.T)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _subtract(image: Image, ground: Image) -> None:
    """Subtract `ground`, linear between the centres of its windows, constant before the first and after the last."""
    rows, columns = image.shape
    n_windows, apart, first = ground.shape[1], _STRIDE * _BIN, (_WINDOW * _BIN) // 2
    for row in range(rows):
        for k in range(-1, n_windows):
            begin = first + k * apart if k >= 0 else 0
            end = first + (k + 1) * apart if k < n_windows - 1 else columns
            level = ground[row, max(k, 0)]
            slope = (ground[row, min(k + 1, n_windows - 1)] - level) / np.float32(apart)
            piece = image[row, begin:end]
            for i in range(piece.size):
                piece[i] -= level + slope * np.float32(i)
