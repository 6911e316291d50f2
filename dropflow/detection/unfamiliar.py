"""Whether a stack looks like what the model of the `default` detection was trained on."""

from typing import Any

import numpy as np

from dropflow.detection.contract import Detector
from dropflow.detection.default.detector import DefaultDetector
from dropflow.preprocess import StackEstimate
from dropflow.preprocess.background import Stack
from dropflow.preprocess.measure import sampled

TOLERATED_SHARE = 0.035
"""1 % of the features of the training's own droplets are beyond its range by definition, up to 2 % in simulated films
with other constants; binarised, ring-like or half-transparent things have 4 to 11 %."""
_N_FRAMES = 2


def unfamiliar_share(frames: Stack, detector: Detector) -> float:
    """Part of the features of droplets that `detector` was not trained for, on a few frames; 0 without a model."""
    if not isinstance(detector, DefaultDetector):
        return 0.0
    shares = [detector.unfamiliar_share(detector.prepare(frames[i])) for i in sampled(len(frames), _N_FRAMES)]
    return float(np.mean(shares))


def warnings_of(estimate: StackEstimate) -> list[dict[str, Any]]:
    """What people who look at the results should know of the detection: code and message of each warning."""
    if estimate.unfamiliar_share <= TOLERATED_SHARE:
        return []
    message = (
        f"{100 * estimate.unfamiliar_share:.0f} % of what was measured of the droplets is beyond what the detection "
        "was trained on (1 to 2 % is usual): probabilities and uncertainties may not hold. "
        "Look at overlays of some frames."
    )
    return [{"code": "detection.unfamiliar", "message": message}]
