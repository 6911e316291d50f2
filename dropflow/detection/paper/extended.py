"""Extended maxima: peaks that stand at least a given height above the way to any higher one.

The regional maxima of the h-maxima transform (Soille, Morphological Image Analysis, section 6.3.5), by union-find over
the pixels in falling order: one pass instead of a morphological reconstruction.
"""

import numba
import numpy as np
import numpy.typing as npt

Levels = npt.NDArray[np.uint8]
Labels = npt.NDArray[np.int32]


def extended_maxima(levels: Levels, height: int) -> tuple[Labels, int]:
    """Label the extended maxima of an image.

    Parameters
    ----------
    levels
        Shape (rows, columns), uint8.
    height
        A peak counts when one must go down at least this far (>= 1) from it to reach a higher one. The lowest level
        of the image stands for the way from the highest peak.

    Returns
    -------
    Labels of shape (rows, columns), int32, 0 outside the maxima and 1..n in them, and n. A maximum is the 8-connected
    region around a peak that is less than `height` below it.
    """
    order = np.argsort(levels.ravel(), kind="stable")[::-1].astype(np.int32)
    peaks = _prominent_peaks(levels.ravel(), order, levels.shape[1], height)
    return _flood(levels, peaks, height), len(peaks)


@numba.njit(cache=True, nogil=True)
def _root(parent: Labels, pixel: int) -> int:
    while parent[pixel] != pixel:
        parent[pixel] = parent[parent[pixel]]
        pixel = parent[pixel]
    return pixel


@numba.njit(cache=True, nogil=True)
def _prominent_peaks(levels: Levels, order: Labels, columns: int, height: int) -> Labels:
    """Flat indices of one pixel of each peak. The root of a set is the first, hence highest, pixel of its peak."""
    n_pixels = levels.size
    rows = n_pixels // columns
    parent = np.full(n_pixels, -1, np.int32)
    is_peak = np.zeros(n_pixels, np.bool_)
    for pixel in order:
        parent[pixel] = pixel
        level = int(levels[pixel])
        row, column = pixel // columns, pixel % columns
        for near_row in range(max(0, row - 1), min(rows, row + 2)):
            for near_column in range(max(0, column - 1), min(columns, column + 2)):
                near = near_row * columns + near_column
                if parent[near] < 0 or near == pixel:
                    continue
                mine, other = _root(parent, pixel), _root(parent, near)
                if mine == other:
                    continue
                if levels[mine] > levels[other]:
                    mine, other = other, mine
                if int(levels[mine]) - level >= height:
                    is_peak[mine] = True
                parent[mine] = other
    last = _root(parent, 0)
    if int(levels[last]) - int(levels[order[n_pixels - 1]]) >= height:
        is_peak[last] = True
    return np.flatnonzero(is_peak).astype(np.int32)


@numba.njit(cache=True, nogil=True)
def _flood(levels: Levels, peaks: Labels, height: int) -> Labels:
    """Label around each peak what is less than `height` below it."""
    rows, columns = levels.shape
    labels = np.zeros((rows, columns), np.int32)
    stack = np.empty(levels.size, np.int32)
    for number in range(peaks.size):
        row, column = peaks[number] // columns, peaks[number] % columns
        lowest = int(levels[row, column]) - height
        labels[row, column] = number + 1
        stack[0] = peaks[number]
        n_stacked = 1
        while n_stacked > 0:
            n_stacked -= 1
            row, column = stack[n_stacked] // columns, stack[n_stacked] % columns
            for near_row in range(max(0, row - 1), min(rows, row + 2)):
                for near_column in range(max(0, column - 1), min(columns, column + 2)):
                    if labels[near_row, near_column] == 0 and int(levels[near_row, near_column]) > lowest:
                        labels[near_row, near_column] = number + 1
                        stack[n_stacked] = near_row * columns + near_column
                        n_stacked += 1
    return labels
