"""Cleaning of one frame: flat field, tone, stripes. Noise and slow changes of brightness are left to the looks."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.stripes import Stripes, direction_of, remove_stripes, stripe_strength

Image = npt.NDArray[np.float32]


@dataclass(frozen=True)
class StripeEstimate:
    """Stripes of a whole stack."""

    stripes: Stripes
    share: float
    """Of what looks like stripes, the part that is."""


def measure_stripes(images: list[Image]) -> StripeEstimate:
    """The direction and share of stripes in corrected frames of one stack."""
    along_rows = float(np.median([stripe_strength(image) for image in images]))
    along_columns = float(np.median([stripe_strength(np.ascontiguousarray(image.T)) for image in images]))
    return StripeEstimate(*direction_of(along_rows, along_columns))


def cleaned(image: Image, stripes: StripeEstimate) -> Image:
    """Take the stripes out of a corrected frame, in place, and return it."""
    remove_stripes(image, stripes.stripes, stripes.share)
    return image
