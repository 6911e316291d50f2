"""What stands still in a film and is no droplet: uneven light and dirt, estimated where no flat field is given.

What the background tells depends on how droplets are seen. Dark droplets stand before a lamp: the background is the
lamp, and dividing by its slow changes is right; its small spots may be droplets that do not move, and stay. Bright
droplets light up before something dark, whose brightness says nothing of the light on them, but whose small dark spots
are dirt that absorbs, which no bright droplet can be mistaken for.
"""

from typing import Any, Protocol

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.experiment import DropletTone
from dropflow.preprocess.filters import Blur, smooth
from dropflow.preprocess.noise import noise_level

Image = npt.NDArray[np.float32]

LEAST_FRAMES = 9
"""In fewer frames droplets have not left their places."""
N_MOST = 11
_ROWS_AT_ONCE = 128
_SLOW_RADII = 3.0
"""Light that changes more slowly than this many largest radii is the lamp's."""
_LEAST_NOISES = 4.0
"""A background nearer to black than so many standard deviations of the noise divides nothing well."""
_DIRT_SIGMAS = 6.0
_DIRT_CELL_PX = 48.0
"""Dirt is told from what is around it in cells of this size."""
_DARK_PERCENT, _MIDDLE_PERCENT, _BRIGHT_PERCENT = 35.0, 50.0, 80.0
_DIRT_DEPTH = 0.05
"""Spots that take less than this share of the light are left alone."""


class Stack(Protocol):
    """Anything with a length whose items are grey frames of shape (rows, columns)."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> npt.NDArray[Any]: ...


def estimated_flat_field(frames: Stack, tone: DropletTone, *, r_max_px: float) -> Image | None:
    """Return a flat field of mean 1, shape (rows, columns), or None where the film does not tell one."""
    if len(frames) < LEAST_FRAMES:
        return None
    background = median_frame(frames)
    noise = noise_level(np.asarray(frames[0], np.float32))
    if not float(np.percentile(background, 1)) > _LEAST_NOISES * noise:
        return None
    flat = _lamp(background, r_max_px) if tone is DropletTone.DARK else _dirt(background)
    return None if flat is None else np.asarray(flat / flat.mean(dtype=np.float64), np.float32)


def median_frame(frames: Stack) -> Image:
    """Median over up to 11 frames spread over the stack: what is not covered most of the time."""
    which = np.unique(np.linspace(0, len(frames) - 1, min(N_MOST, len(frames))).round()).astype(int)
    stack = np.stack([frames[int(index)] for index in which])
    result = np.empty(stack.shape[1:], np.float32)
    for top in range(0, len(result), _ROWS_AT_ONCE):
        rows = slice(top, top + _ROWS_AT_ONCE)
        result[rows] = np.median(stack[:, rows], axis=0)
    return result


def dirt_map(flat_field: Image) -> npt.NDArray[np.bool_]:
    """Where a flat field has small spots that take more than 5 % of the light, shape (rows, columns)."""
    return np.asarray(flat_field / _envelope(flat_field, _DIRT_CELL_PX, _MIDDLE_PERCENT) < 1 - _DIRT_DEPTH)


def _lamp(background: Image, r_max_px: float) -> Image:
    """The slow changes of what is brightest everywhere: dark droplets that stay make no shadow in it."""
    light = _envelope(background, max(_DIRT_CELL_PX, r_max_px), _BRIGHT_PERCENT)
    return smooth(light, Blur(_SLOW_RADII * r_max_px, _SLOW_RADII * r_max_px))


def _dirt(background: Image) -> Image | None:
    """Share of light that passes small dark spots, 1 elsewhere; None where there is no spot.

    Beside the lower levels around, not their mean: the gaps between bright droplets that stay are no dirt.
    """
    relative = background / _envelope(background, _DIRT_CELL_PX, _DARK_PERCENT, is_least_of_neighbours=True)
    noise = 1.4826 * float(np.median(np.abs(relative - np.median(relative))))
    is_dirt = relative < 1 - max(_DIRT_DEPTH, _DIRT_SIGMAS * noise)
    # Spots with their soft edges; single pixels are noise.
    spots = cv2.morphologyEx(is_dirt.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8))
    if not spots.any():
        return None
    around = cv2.dilate(spots, np.ones((5, 5), np.uint8)).astype(bool)
    return np.where(around, np.minimum(relative, np.float32(1)), np.float32(1))


def _envelope(image: Image, cell_px: float, percent: float, *, is_least_of_neighbours: bool = False) -> Image:
    """A percentile of each cell of about this size, linear between their centres."""
    rows, columns = image.shape
    n_rows, n_columns = (max(1, round(side / cell_px)) for side in image.shape)
    cells = [
        [np.percentile(part, percent) for part in np.array_split(band, n_columns, axis=1)]
        for band in np.array_split(image, n_rows)
    ]
    levels = np.array(cells, np.float32)
    if is_least_of_neighbours:
        levels = np.asarray(cv2.erode(levels, np.ones((3, 3), np.uint8)), np.float32)
    wide = cv2.resize(levels, (columns, rows), interpolation=cv2.INTER_LINEAR)
    return np.maximum(np.asarray(wide, np.float32), np.finfo(np.float32).tiny)
