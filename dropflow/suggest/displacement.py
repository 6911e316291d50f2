"""How far droplets move from frame to frame, from pairs of the same size and without following any of them."""

from dataclasses import dataclass
from math import sqrt

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets

Column = npt.NDArray[np.float64]

_N_BLOCKS_X, _N_BLOCKS_Y = 5, 4
_REACH_SPACINGS = 2.5
"""Displacements up to so many mean spacings are told."""
_N_BINS = 61
_SIMILAR = 0.12
"""Radii of one droplet in two frames differ by at most this in their logarithm."""
_LEAST_SHARE = 0.3
"""Of the droplets of a part, so many agree on the displacement ..."""
_CLEAR = 5.0
"""... and these are so many times what pairs of unlike droplets give by chance, in standard deviations of it."""
_AROUND_BINS = 3
_LEAST_DROPLETS = 6


@dataclass(frozen=True)
class Displacement:
    """Of droplets between two frames; None where no common motion stands out."""

    typical_px: float | None
    """Median over parts of the frame."""
    largest_px: float | None
    """In the part where it is largest."""
    spacing_px: float
    """Mean distance sqrt(area / number) of droplets."""


def displacement(before: Droplets, after: Droplets, shape: tuple[int, int]) -> Displacement:
    """Find the commonest displacement in each of 5 x 4 parts of the frame.

    Every pair of droplets of like radius votes for the displacement between them. Those of one and the same droplet
    agree within a part of the frame, all others are spread evenly.
    """
    rows, columns = shape
    spacing_px = sqrt(rows * columns / max(len(before), 1))
    found = []
    for row in range(_N_BLOCKS_Y):
        for column in range(_N_BLOCKS_X):
            is_here = (before.x_px // (columns / _N_BLOCKS_X) == column) & (before.y_px // (rows / _N_BLOCKS_Y) == row)
            moved = _commonest(before[is_here], after, _REACH_SPACINGS * spacing_px)
            if moved is not None:
                found.append(moved)
    if not found:
        return Displacement(None, None, spacing_px)
    return Displacement(float(np.median(found)), float(np.max(found)), spacing_px)


def _commonest(before: Droplets, after: Droplets, reach_px: float) -> float | None:
    if len(before) < _LEAST_DROPLETS:
        return None
    dx, dy = after.x_px[None, :] - before.x_px[:, None], after.y_px[None, :] - before.y_px[:, None]
    is_pair = (np.abs(dx) < reach_px) & (np.abs(dy) < reach_px)
    is_pair &= np.abs(np.log(after.r_px[None, :] / before.r_px[:, None])) < _SIMILAR
    edges = np.linspace(-reach_px, reach_px, _N_BINS + 1)
    votes = np.histogram2d(dx[is_pair], dy[is_pair], bins=[edges, edges])[0].astype(np.float32)
    agreeing = cv2.boxFilter(votes, -1, (_AROUND_BINS, _AROUND_BINS), normalize=False, borderType=cv2.BORDER_CONSTANT)
    smooth = np.asarray(cv2.GaussianBlur(agreeing, (0, 0), 1.0), np.float32)
    peak = np.unravel_index(np.argmax(smooth), smooth.shape)
    by_chance = float(votes.mean()) * _AROUND_BINS**2
    if agreeing[peak] - by_chance < max(_LEAST_SHARE * len(before), _CLEAR * sqrt(by_chance)):
        return None
    middles, near_px = (edges[:-1] + edges[1:]) / 2, _AROUND_BINS / 2 * (edges[1] - edges[0])
    # Bins are several pixels wide: the median of those that agree tells more.
    agree = is_pair & (np.abs(dx - middles[peak[0]]) < near_px) & (np.abs(dy - middles[peak[1]]) < near_px)
    return float(np.hypot(np.median(dx[agree]), np.median(dy[agree])))
