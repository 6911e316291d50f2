"""Edges: pixels where brightness changes faster than on either side along the gradient."""

from math import sqrt

import numba
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]
Values = npt.NDArray[np.float32]

_STEEP = np.float32(2.4142135)
"""tan(67.5 degrees): gradients are compared with the neighbours nearest to their direction."""
_BLOCK = 32
"""So many pixels are passed at once where none is steep enough."""


@numba.njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def thin_edges(image: Image, least: np.float32, x: Values, y: Values, u: Values, v: Values) -> int:
    """Write places and directions (unit vectors uphill) of edges with differences over two pixels above `least`.

    Returns the number of edges, at most the length of `x`.
    """
    rows, columns = image.shape
    # Squared gradients of three rows are kept; a row of them is made by vector instructions.
    square = np.zeros((3, columns), np.float32)
    least_square = least * least
    n = 0
    for row in range(1, rows - 1):
        below = square[row % 3]
        _squared_gradient(image[row - 1], image[row], image[row + 1], below)
        if row < 3:
            continue
        here, above = square[(row - 1) % 3], square[(row - 2) % 3]
        for begin in range(2, columns - 2, _BLOCK):
            end = min(begin + _BLOCK, columns - 2)
            most = np.float32(0)
            for column in range(begin, end):
                most = max(most, here[column])
            if most < least_square:
                continue
            for column in range(begin, end):
                value = here[column]
                if value < least_square:
                    continue
                p = image[row - 1, column + 1] - image[row - 1, column - 1]
                q = image[row, column] - image[row - 2, column]
                if abs(p) > _STEEP * abs(q):
                    before, after = here[column - 1], here[column + 1]
                elif abs(q) > _STEEP * abs(p):
                    before, after = above[column], below[column]
                elif p * q > 0:
                    before, after = above[column - 1], below[column + 1]
                else:
                    before, after = above[column + 1], below[column - 1]
                if before > value or after > value or n >= x.size:
                    continue
                length = np.float32(1) / np.float32(sqrt(value))
                x[n], y[n] = column, row - 1
                u[n], v[n] = p * length, q * length
                n += 1
    return n


@numba.njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _squared_gradient(above: Values, here: Values, below: Values, square: Values) -> None:
    right, left = here[2:], here[:-2]
    up, down, result = above[1:-1], below[1:-1], square[1:-1]
    for column in range(result.size):
        p, q = right[column] - left[column], down[column] - up[column]
        result[column] = p * p + q * q
