"""The first strategy of section 3.1.2: thresholds, and maxima of the distance to the background."""

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection.paper.circles import Circles
from dropflow.parameters import PaperDetection

Image = npt.NDArray[np.float32]
Mask = npt.NDArray[np.uint8]

N_LEVELS = 256


def background_level(image: Image) -> float:
    """Return the most frequent grey level, 0 to 255: that of what is between the droplets."""
    counts = cv2.calcHist([image], [0], None, [N_LEVELS], [0, N_LEVELS]).ravel()
    return float(np.argmax(np.convolve(counts, np.ones(5) / 5, mode="same"))) + 0.5


def threshold_levels(background: float, noise: float, knobs: PaperDetection) -> tuple[float, float]:
    """Return the threshold for small droplets and the one for big ones, in levels 0 to 255.

    The paper does not say its two thresholds. A fixed level cannot serve, for the level of the background in the
    stretched frame depends on how many droplets there are: both are parts of the way from it to white, and above its
    noise (a standard deviation), so that a frame of nothing but noise has no droplets.
    """
    floor = background + knobs.noise_margin * noise
    way = 255 - background
    small, big = (background + part * way for part in (knobs.threshold_small, knobs.threshold_big))
    return max(small, floor), max(big, floor)


def find_by_threshold(image: Image, level: float, *, r_min_px: float, r_max_px: float) -> Circles:
    """Find circles around the local maxima of the distance to the background.

    Parameters
    ----------
    image
        Prepared frame, shape (rows, columns), float32, levels 0 to 255.
    level
        Pixels darker than this are background.
    r_min_px, r_max_px
        Radii looked for, in pixels of `image`.

    Returns
    -------
    Circles in pixels of `image`, one for each maximum at least `r_min_px` from any other.
    """
    droplets = (image >= level).astype(np.uint8)
    _fill_isolated_background(droplets, max_area_px=np.pi * r_max_px**2)
    if not droplets.any() or droplets.all():
        return Circles.none()
    distance = np.asarray(cv2.distanceTransform(droplets, cv2.DIST_L2, cv2.DIST_MASK_5), np.float32)
    return _maxima(distance, r_min_px=r_min_px, r_max_px=r_max_px)


def _fill_isolated_background(droplets: Mask, max_area_px: float) -> None:
    """Count background wholly surrounded by droplets, and no larger than the largest droplet, as droplet (in place)."""
    contours, hierarchy = cv2.findContours(droplets, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE)
    if not contours:
        return
    is_hole = hierarchy[0, :, 3] >= 0
    for i, contour in enumerate(contours):
        if is_hole[i] and cv2.contourArea(contour) <= max_area_px:
            cv2.drawContours(droplets, contours, i, (1,), thickness=cv2.FILLED)


def _maxima(distance: Image, *, r_min_px: float, r_max_px: float) -> Circles:
    """Local maxima of a distance map within a window of one smallest radius; a plateau counts once, at its centroid."""
    reach = max(1, round(r_min_px))
    window = cv2.getStructuringElement(cv2.MORPH_RECT, (2 * reach + 1, 2 * reach + 1))
    is_maximum = (distance >= cv2.dilate(distance, window)) & (distance >= r_min_px) & (distance <= r_max_px)
    n_labels, labels, _, centroids = cv2.connectedComponentsWithStats(is_maximum.astype(np.uint8), connectivity=8)
    if n_labels == 1:
        return Circles.none()
    rows, columns = np.nonzero(is_maximum)
    radius = np.zeros(n_labels)
    radius[labels[rows, columns]] = distance[rows, columns]
    # The distance is to the centre of the nearest background pixel; the edge is half a pixel nearer.
    x_px, y_px = np.asarray(centroids[1:], np.float64).T
    return Circles(x_px, y_px, radius[1:] - 0.5)
