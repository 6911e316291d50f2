"""The second strategy of section 3.1.2: a watershed of the intensity gradient, controlled by markers.

After Gonzalez, Woods and Eddins (2004), pp. 422: extended maxima mark droplets; the lines midway between them and the
extended minima mark background; the gradient is flooded from the markers alone.
"""

import cv2
import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.paper.circles import Circles
from dropflow.detection.paper.extended import extended_maxima

Image = npt.NDArray[np.float32]
Levels = npt.NDArray[np.uint8]
Labels = npt.NDArray[np.int32]

BACKGROUND = 1
"""Label of all background markers; droplets follow."""


def find_by_watershed(image: Image, *, maxima_height: float, r_min_px: float, r_max_px: float) -> Circles:
    """Find circles with the area and the centroid of the regions that watershed lines enclose.

    Parameters
    ----------
    image
        Prepared frame, shape (rows, columns), float32, levels 0 to 255.
    maxima_height
        Height of extended maxima and depth of extended minima, levels.
    r_min_px, r_max_px
        Radii looked for, in pixels of `image`.

    Returns
    -------
    Circles in pixels of `image`.
    """
    levels = np.rint(image).astype(np.uint8)
    height = max(1, round(maxima_height))
    maxima, n_maxima = extended_maxima(levels, height)
    if n_maxima == 0:
        return Circles.none()
    markers = droplet_markers(levels, maxima, height)
    regions = flood(gradient(image), markers)
    return _circles(regions, n_maxima, r_min_px=r_min_px, r_max_px=r_max_px)


def droplet_markers(levels: Levels, maxima: Labels, height: int) -> Labels:
    """Droplet markers from 2 on, one background marker, 0 where the flood decides."""
    markers = np.where(maxima > 0, maxima + BACKGROUND, 0).astype(np.int32)
    dark, _ = extended_maxima(255 - levels, height)
    markers[((dark > 0) | _lines_between(maxima)) & (markers == 0)] = BACKGROUND
    return markers


def _lines_between(maxima: Labels) -> npt.NDArray[np.bool_]:
    """Lines of equal distance to two maxima: the watershed of the distance to the nearest one."""
    _, nearest = cv2.distanceTransformWithLabels(
        (maxima == 0).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_CCOMP
    )
    is_line = np.zeros(maxima.shape, np.bool_)
    is_line[:, :-1] |= nearest[:, :-1] != nearest[:, 1:]
    is_line[:-1] |= nearest[:-1] != nearest[1:]
    return is_line


def gradient(image: Image) -> Levels:
    """Sobel magnitude on 0..255: its square root, for the gradients of faint edges would else share one level."""
    along_x = cv2.Sobel(image, cv2.CV_32F, 1, 0)
    along_y = cv2.Sobel(image, cv2.CV_32F, 0, 1)
    steepness = np.sqrt(cv2.magnitude(along_x, along_y))
    steepest = float(steepness.max())
    if steepest > 0:
        steepness *= np.float32(255 / steepest)
    return np.rint(steepness).astype(np.uint8)


@numba.njit(cache=True, nogil=True)
def flood(gradient: Levels, markers: Labels) -> Labels:
    """Flood `gradient` from `markers` in the order of its levels (Meyer's algorithm); every pixel gets a label.

    Parameters
    ----------
    gradient
        Shape (rows, columns), uint8.
    markers
        Shape (rows, columns), int32, 0 where there is none; at least one pixel must be marked.

    Returns
    -------
    Shape (rows, columns), int32.
    """
    rows, columns = gradient.shape
    labels = markers.copy()
    # One first-in-first-out queue a level, as linked lists through the pixels: each is queued once.
    head = np.full(256, -1, np.int32)
    tail = np.full(256, -1, np.int32)
    following = np.full(gradient.size, -1, np.int32)
    for row in range(rows):
        for column in range(columns):
            if markers[row, column] > 0:
                level = 0
                pixel = row * columns + column
                if head[level] < 0:
                    head[level] = pixel
                else:
                    following[tail[level]] = pixel
                tail[level] = pixel
    level = 0
    while level < 256:
        pixel = head[level]
        if pixel < 0:
            level += 1
            continue
        head[level] = following[pixel]
        row, column = pixel // columns, pixel % columns
        label = labels[row, column]
        for side in range(4):
            near_row = row + (1 if side == 0 else -1 if side == 1 else 0)
            near_column = column + (1 if side == 2 else -1 if side == 3 else 0)
            if near_row < 0 or near_column < 0 or near_row >= rows or near_column >= columns:
                continue
            if labels[near_row, near_column] != 0:
                continue
            labels[near_row, near_column] = label
            at = max(level, int(gradient[near_row, near_column]))
            near = near_row * columns + near_column
            following[near] = -1
            if head[at] < 0:
                head[at] = near
            else:
                following[tail[at]] = near
            tail[at] = near
    return labels


def _circles(regions: Labels, n_maxima: int, *, r_min_px: float, r_max_px: float) -> Circles:
    """Circles of the area and centroid of each droplet's region, where their radius is one looked for."""
    area, x_sum, y_sum = _sums(regions, n_maxima + BACKGROUND + 1)
    droplets = slice(BACKGROUND + 1, None)
    radius = np.sqrt(area[droplets] / np.pi)
    circles = Circles(x_sum[droplets] / area[droplets], y_sum[droplets] / area[droplets], radius)
    return circles[(radius >= r_min_px) & (radius <= r_max_px)]


@numba.njit(cache=True, nogil=True)
def _sums(regions: Labels, n_labels: int) -> npt.NDArray[np.float64]:
    """Number of pixels of each label, and the sums of their columns and rows; shape (3, n_labels)."""
    rows, columns = regions.shape
    result = np.zeros((3, n_labels))
    for row in range(rows):
        column = 0
        while column < columns:
            label, begin = regions[row, column], column
            while column < columns and regions[row, column] == label:
                column += 1
            n = column - begin
            result[0, label] += n
            result[1, label] += n * (begin + column - 1) * 0.5
            result[2, label] += n * row
    return result
