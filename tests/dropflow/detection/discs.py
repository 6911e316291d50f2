"""Frames with discs whose places are known: the simplest thing that a detector must find."""

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection import make_detector
from dropflow.detection.contract import Detector
from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, parse_experiment
from dropflow.parameters import Parameters, parse_parameters
from dropflow.preprocess import estimate_stack

Disc = tuple[float, float, float]
"""x, y and r in px."""

SHAPE = (300, 360)
ISOLATED: tuple[Disc, ...] = (
    (60, 70, 9),
    (180.4, 60.7, 16),
    (300, 90, 24),
    (90, 200, 30),
    (220.5, 180.2, 12),
    (310, 250, 7),
)
OVERLAPPING: tuple[Disc, ...] = ((100, 150, 26), (138, 160, 22), (250, 120, 30), (240, 112, 8))


def draw(
    discs: Sequence[Disc],
    *,
    shape: tuple[int, int] = SHAPE,
    level: float = 30,
    contrast: float = 120,
    noise: float = 1.5,
) -> npt.NDArray[np.uint8]:
    """Droplets as the paper's camera sees them: chords of spheres, overlaps added up, a little blur and noise."""
    rows, columns = np.indices(shape, np.float32)
    image = np.full(shape, level, np.float32)
    for x, y, r in discs:
        squared = np.maximum(r * r - (columns - x) ** 2 - (rows - y) ** 2, 0)
        image += contrast * np.minimum(np.sqrt(squared) / min(r, 15), 1)
    image = cv2.GaussianBlur(image, (0, 0), 1.0)
    image += np.random.default_rng(1).normal(0, noise, shape).astype(np.float32)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def experiment(**fields: Any) -> Experiment:
    """An experiment with 1 um per pixel."""
    return parse_experiment(
        {"name": "discs", "pixel_size_um": 1.0, "frame_interval_s": 1.0, "droplets": "bright", "material": "none"}
        | fields
    )


def parameters(**detection: Any) -> Parameters:
    """Parameters for radii of 5 to 40 px."""
    return parse_parameters({"detection": {"radius_min_um": 5.0, "radius_max_um": 40.0} | detection})


def detector_for(frame: npt.NDArray[Any], *, tone: str = "bright", **detection: Any) -> Detector:
    """The detector of a stack of this one frame."""
    film, knobs = experiment(droplets=tone), parameters(**detection)
    return make_detector(film, knobs, estimate_stack([frame], film, knobs))


def find(frame: npt.NDArray[Any], **options: Any) -> Droplets:
    """Detect the droplets of one frame."""
    detector = detector_for(frame, **options)
    return detector.detect(detector.prepare(frame)).droplets


def nearest(droplets: Droplets, disc: Disc) -> tuple[float, float]:
    """Return distance, px, and ratio of radii, of the droplet that is most like a disc."""
    x, y, r = disc
    distance = np.hypot(droplets.x_px - x, droplets.y_px - y)
    unlike = distance / r + np.abs(np.log(droplets.r_px / r))
    best = int(np.argmin(unlike))
    return float(distance[best]), float(droplets.r_px[best] / r)
