"""Extended maxima: peaks that stand at least a given height above the way to any higher one.

The regional maxima of the h-maxima transform (Soille, Morphological Image Analysis, section 6.3.5), by floods from the
local maxima in falling order: one pass instead of a morphological reconstruction.
"""

import cv2
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
    tops = np.flatnonzero(levels == cv2.dilate(levels, np.ones((3, 3), np.uint8)))
    order = tops[np.argsort(~levels.ravel()[tops], kind="stable")]
    return _floods(levels, order.astype(np.int32), height, int(levels.min()))


@numba.njit(cache=True, nogil=True)
def _floods(levels: Levels, tops: Labels, height: int, lowest: int) -> tuple[Labels, int]:
    """Labels of the maxima, and how many there are; `tops` holds flat indices of the local maxima, the highest first.

    From each the image is flooded as far as `height` below it. A flood that meets something higher, or what an earlier
    flood has reached (from where one comes to its top without going lower), has started from no peak of its own.
    Hence no pixel is passed twice.
    """
    rows, columns = levels.shape
    reached = np.zeros((rows, columns), np.int32)
    number_of = np.zeros(tops.size + 1, np.int32)
    stack = np.empty(levels.size, np.int32)
    n_maxima = 0
    for flood in range(1, tops.size + 1):
        row, column = tops[flood - 1] // columns, tops[flood - 1] % columns
        if reached[row, column] != 0:
            continue
        top = int(levels[row, column])
        floor = top - height
        is_peak = floor >= lowest
        reached[row, column] = flood
        stack[0] = tops[flood - 1]
        n_stacked = 1
        while n_stacked > 0 and is_peak:
            n_stacked -= 1
            row, column = stack[n_stacked] // columns, stack[n_stacked] % columns
            for near_row in range(max(0, row - 1), min(rows, row + 2)):
                for near_column in range(max(0, column - 1), min(columns, column + 2)):
                    level, by = int(levels[near_row, near_column]), reached[near_row, near_column]
                    if level <= floor or by == flood:
                        continue
                    if level > top or by != 0:
                        is_peak = False
                        continue
                    reached[near_row, near_column] = flood
                    stack[n_stacked] = near_row * columns + near_column
                    n_stacked += 1
        if is_peak:
            n_maxima += 1
            number_of[flood] = n_maxima
    for row in range(rows):
        for column in range(columns):
            reached[row, column] = number_of[reached[row, column]]
    return reached, n_maxima
