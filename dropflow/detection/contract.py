"""What every way of detecting droplets offers: the one contract that the pipeline and tracking rely on."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets

Frame = npt.NDArray[Any]
"""One grey frame as read, shape (rows, columns), any real dtype."""
Image = npt.NDArray[np.float32]
"""One preprocessed frame, shape (rows, columns), droplets bright; its scale belongs to the detector that made it."""


class Step(NamedTuple):
    """A frame as it is after one step of preparing it."""

    name: str
    """Stable word: ``flat_field``, ``stripes``, ``band_pass``, ``contrast``."""
    about: str
    image: Image


@dataclass(frozen=True)
class Rejected:
    """Candidates that were not accepted, and why, in one word each.

    ``unlikely`` (probability too small), ``match`` (too small), ``duplicate`` (a better circle is there), ``radius``
    (not one that was looked for).
    """

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

    def steps(self, frame: Frame) -> Iterator[Step]:
        """Each step of `prepare` by itself, for people to look at; the last one is its result."""
        ...

    def detect(self, image: Image) -> Detection:
        """Find the droplets of a prepared frame."""
        ...

    def find_near(self, image: Image, predicted: Droplets, known: Droplets) -> tuple[Droplets, npt.NDArray[np.bool_]]:
        """Look for one droplet near each prediction (x, y, r), as tracking does where detection missed one.

        `known` is what `detect` found in this frame: a detector may take it for granted. It may be empty.

        Returns the best local droplets, as many as predictions, and whether each is good enough to be one.
        """
        ...
