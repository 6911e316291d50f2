"""What every way of detecting droplets offers: the one contract that the pipeline and tracking rely on."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets

Frame = npt.NDArray[Any]
"""One grey frame as read, shape (rows, columns), any real dtype."""
Image = npt.NDArray[np.float32]
"""One preprocessed frame, shape (rows, columns), droplets bright; its scale belongs to the detector that made it."""


@dataclass(frozen=True)
class Rejected:
    """Candidates that were not accepted, and why (one word each, e.g. ``match``, ``duplicate``, ``radius``)."""

    droplets: Droplets
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Detection:
    """The result of looking at one frame."""

    droplets: Droplets
    rejected: Rejected


class Detector(Protocol):
    """Finds the droplets of single frames, made by `dropflow.detection.make_detector`. No state between frames."""

    def prepare(self, frame: Frame) -> Image:
        """Clean one frame: flat field, stripes, noise, contrast; `droplets: dark` is inverted here."""
        ...

    def detect(self, image: Image) -> Detection:
        """Find the droplets of a prepared frame."""
        ...

    def find_near(self, image: Image, predicted: Droplets) -> tuple[Droplets, npt.NDArray[np.bool_]]:
        """Look for one droplet near each prediction (x, y, r), as tracking does where detection missed one.

        Returns the best local droplets, as many as predictions, and whether each is good enough to be one.
        """
        ...
