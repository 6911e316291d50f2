"""What is measured of a stack before it is analysed, each number with its unit and what it says."""

from dataclasses import dataclass

import numpy as np

from dropflow.detection.default.detector import DefaultDetector
from dropflow.detection.default.features import CONTRAST_USUAL, LOG_R, WIDTH
from dropflow.detection.default.model import probability_of
from dropflow.droplets import Droplets
from dropflow.preprocess.background import Stack
from dropflow.preprocess.estimate import StackEstimate
from dropflow.preprocess.stripes import Direction, strength

_SURE = 0.8
_WIDTH_OF_SIGMA = 1.349
"""Distance between a quarter and three quarters of a Gaussian edge, in its standard deviations."""
_SHARPEST_PERCENT = 10


@dataclass(frozen=True)
class Measurement:
    """One number. `value` is None where too little was seen to tell."""

    name: str
    value: float | None
    unit: str
    about: str


@dataclass(frozen=True, eq=False)
class Seen:
    """What a wide search saw in some frames."""

    droplets: tuple[Droplets, ...]
    """Sure ones, of each frame."""
    noise: float
    contrast: float | None
    blur_px: float | None
    stripes: float
    unfamiliar_share: float
    """Part of the features of droplets that the model was not trained for."""


def look_around(frames: Stack, which: list[int], detector: DefaultDetector) -> Seen:
    """Search the frames `which` with a detector of a wide range of radii."""
    droplets, noise, contrasts, widths_px, stripes, unfamiliar = [], [], [], [], [], []
    for index in which:
        image = detector.prepare(frames[index])
        first, again = detector.look(image)
        found = detector.accepted(again).droplets
        droplets.append(found[found.probability >= _SURE])
        unfamiliar.append(detector.unfamiliar_share_of(again))
        noise.append(first.noise)
        stripes.append(max(strength(image), strength(image.T)))
        features = first.sightings.features
        is_sure = probability_of(first.log_odds(detector.model)) >= _SURE
        contrasts.append(features[is_sure, CONTRAST_USUAL] * first.usual.contrast)
        widths_px.append(features[is_sure, WIDTH] * np.exp(features[is_sure, LOG_R]))
    contrast, width_px = np.concatenate(contrasts), np.concatenate(widths_px)
    width_px = width_px[np.isfinite(width_px)]
    return Seen(
        tuple(droplets),
        float(np.median(noise)),
        float(np.median(contrast)) if len(contrast) else None,
        float(np.percentile(width_px, _SHARPEST_PERCENT)) / _WIDTH_OF_SIGMA if len(width_px) else None,
        float(np.median(stripes)),
        float(np.mean(unfamiliar)),
    )


def measurements_of(seen: Seen, estimate: StackEstimate) -> list[Measurement]:
    """Noise, contrast, blur, stripes, radii and number."""
    radii_px = np.concatenate([droplets.r_px for droplets in seen.droplets])
    low, middle, high = np.percentile(radii_px, [2, 50, 98]) if len(radii_px) else (None, None, None)
    direction = estimate.stripes.direction
    stripes = 0.0 if direction is Direction.NONE else seen.stripes
    lines = "none" if direction is Direction.NONE else f"lines along {direction.value}"
    number = float(np.mean([len(droplets) for droplets in seen.droplets]))
    signal = None if seen.contrast is None else seen.contrast / seen.noise
    return [
        Measurement("noise", seen.noise, "levels", "standard deviation of one pixel"),
        Measurement("contrast", seen.contrast, "levels", "of the usual droplet above what is around it"),
        Measurement("contrast_over_noise", signal, "1", "below about 2, faint droplets are missed"),
        Measurement("blur", seen.blur_px, "px", "standard deviation of the sharpest edges"),
        Measurement("stripes", stripes, "levels", lines),
        Measurement("n_droplets", number, "droplets/frame", f"with a probability of at least {_SURE:g}"),
        Measurement("radius_low", low, "px", "2 % of the droplets are smaller"),
        Measurement("radius_median", middle, "px", "half of the droplets are smaller"),
        Measurement("radius_high", high, "px", "2 % of the droplets are larger"),
    ]
