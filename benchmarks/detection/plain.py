"""Sections 3.1.1 to 3.1.3 of the paper, written down plainly with NumPy, SciPy and scikit-image."""

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import fft, ndimage
from skimage import feature, filters, morphology, segmentation

Column = npt.NDArray[np.float64]
Circle = tuple[float, float, float]


def plain_paper(
    frame: npt.NDArray[Any], flat_field: npt.NDArray[Any], *, is_dark: bool, r_min_px: float, r_max_px: float
) -> tuple[Column, Column, Column, Column]:
    """x, y, r and match of droplets."""
    image = _prepared(frame / (flat_field / flat_field.mean()) * (-1 if is_dark else 1))
    circles = [circle for level in (0.2, 0.5) for circle in _by_threshold(image, level)] + _by_watershed(image)
    circles = [circle for circle in circles if 0.7 * r_min_px <= circle[2] <= 1.4 * r_max_px]
    climbed = [_climbed(image, circle) for circle in circles]
    kept = _without_duplicates([(c, m) for c, m in climbed if m > 0.08 and r_min_px <= c[2] <= r_max_px])
    rows = np.array([[*circle, match] for circle, match in kept]).reshape(-1, 4)
    return rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3]


def _prepared(image: npt.NDArray[Any]) -> Column:
    """Band pass in the spectrum, contrast 0 to 255."""
    v, u = np.meshgrid(*(fft.fftfreq(side, 1 / side) for side in image.shape), indexing="ij")
    high = 1 - np.exp(-(u**2) / (2 * 5**2) - v**2 / (2 * 200**2))
    filtered = fft.ifft2(fft.fft2(image) * high * np.exp(-(u**2 + v**2) / (2 * 100**2))).real
    low, top = np.percentile(filtered, [1, 99.7])
    return np.clip((filtered - low) / max(top - low, 1e-9) * 255, 0, 255)


def _by_threshold(image: Column, level: float) -> list[Circle]:
    background = float(np.median(image))
    distance = ndimage.distance_transform_edt(image > background + level * (255 - background))
    places = feature.peak_local_max(ndimage.gaussian_filter(distance, 1), min_distance=3, threshold_abs=2)
    return [(float(x), float(y), float(distance[y, x])) for y, x in places]


def _by_watershed(image: Column) -> list[Circle]:
    levels = np.rint(image).astype(np.uint8)
    maxima, minima = morphology.h_maxima(levels, 10), morphology.h_minima(levels, 10)
    markers, n = ndimage.label(maxima)
    background = segmentation.watershed(ndimage.distance_transform_edt(markers == 0), markers, watershed_line=True) == 0
    markers[background & (markers == 0)] = n + 1
    markers[(minima > 0) & (markers == 0)] = n + 1
    regions = segmentation.watershed(filters.sobel(image), markers)
    indices = np.arange(1, n + 1)
    areas = ndimage.sum_labels(np.ones_like(image), regions, indices)
    centres = ndimage.center_of_mass(np.ones_like(image), regions, indices)
    return [(x, y, float(np.sqrt(a / np.pi))) for (y, x), a in zip(centres, areas, strict=True)]


def _match(image: Column, circle: Circle) -> float:
    """Eq. 3: disk against a ring of 3 px, less what the ring's centre of light is off."""
    x, y, r = circle
    left, top = int(max(x - r - 4, 0)), int(max(y - r - 4, 0))
    piece = image[top : int(y + r + 5), left : int(x + r + 5)]
    if piece.size == 0 or r < 1:
        return -np.inf
    rows, columns = np.indices(piece.shape)
    dx, dy = columns + left - x, rows + top - y
    distance = np.hypot(dx, dy)
    disk, ring = distance <= r, (distance > r) & (distance <= r + 3)
    if not disk.any() or not ring.any():
        return -np.inf
    light = piece[ring]
    total = max(float(light.sum()), 1e-9)
    off = np.hypot(float((dx[ring] * light).sum()) / total, float((dy[ring] * light).sum()) / total)
    return float((piece[disk].mean() - light.mean() - 3 * off) / (30 + r**1.3))


def _climbed(image: Column, circle: Circle) -> tuple[Circle, float]:
    """Steps of one pixel in x, y and r to the best match."""
    best = _match(image, circle)
    for _ in range(20):
        x, y, r = circle
        beside = [(x + 1, y, r), (x - 1, y, r), (x, y + 1, r), (x, y - 1, r), (x, y, r + 1), (x, y, r - 1)]
        matches = [_match(image, other) for other in beside]
        if max(matches) <= best:
            break
        best = max(matches)
        circle = beside[int(np.argmax(matches))]
    return circle, best


def _without_duplicates(found: list[tuple[Circle, float]]) -> list[tuple[Circle, float]]:
    kept: list[tuple[Circle, float]] = []
    for (x, y, r), match in sorted(found, key=lambda one: -one[1]):
        if not any(np.hypot(x - a, y - b) < min(r, c) and 0.7 < r / c < 1.4 for (a, b, c), _ in kept):
            kept.append(((x, y, r), match))
    return kept
