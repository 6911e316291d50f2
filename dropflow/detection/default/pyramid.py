"""The same image at full, half, quarter ... size: droplets of any radius are looked at with about as many pixels."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

LEAST_RADIUS_PX = 4.0
"""The smallest level is the one on which the largest droplet still has this radius."""


@dataclass(frozen=True)
class Level:
    """One image of a pyramid; its pixels are `factor` times as wide as those of the frame."""

    image: Image
    factor: float

    def x_from_frame(self, x_px: Column) -> Column:
        """Coordinates of the frame in those of this level (centres of pixels are whole numbers in both)."""
        return np.asarray((x_px + 0.5) / self.factor - 0.5)

    def x_to_frame(self, x: Column) -> Column:
        """Coordinates of this level in those of the frame."""
        return np.asarray((x + 0.5) * self.factor - 0.5)


def halved(image: Image) -> Image:
    """Means over blocks of exactly 2 x 2 pixels; an odd last row or column is left out, or places would be scaled."""
    rows, columns = image.shape[0] // 2, image.shape[1] // 2
    whole = image[: 2 * rows, : 2 * columns]
    return np.asarray(cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA), np.float32)


def doubled(image: Image) -> Image:
    """Twice as many rows and columns, linear between pixels."""
    rows, columns = image.shape
    return np.asarray(cv2.resize(image, (2 * columns, 2 * rows), interpolation=cv2.INTER_LINEAR), np.float32)


def pyramid(image: Image, r_max_px: float) -> list[Level]:
    """`image` and its halves, down to where a radius of `r_max_px` is about `LEAST_RADIUS_PX`."""
    levels = [Level(image, 1.0)]
    while r_max_px / (2 * levels[-1].factor) >= LEAST_RADIUS_PX and min(levels[-1].image.shape) >= 16:
        levels.append(Level(halved(levels[-1].image), 2 * levels[-1].factor))
    return levels


def level_of(r_px: Column, levels: list[Level], *, finest_px: float) -> npt.NDArray[np.int64]:
    """Index of the level on which each radius is between `finest_px` and twice that many pixels (or the nearest)."""
    wanted = np.floor(np.log2(np.maximum(r_px, 1e-3) / finest_px)).astype(np.int64)
    return np.clip(wanted, 0, len(levels) - 1)
