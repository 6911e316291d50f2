"""What the frames so far have shown to be usual."""

from dataclasses import dataclass

import numpy as np

from dropflow.tracking.grid import Column

_KEPT = 0.9
"""Weight of the past in running averages."""
_MEDIAN_OF_SQUARES = 1.386
"""Of the squared distance of two normal variables in units of their standard deviation."""
_WIDENING_POWER = 0.2
_LEAST_PAIRS = 10


@dataclass(frozen=True)
class Scales:
    """Running averages over frames."""

    detected: float = 0.85
    """Share of the followed droplets that are detected in the next frame."""
    surprising: float = 0.5
    """Share of the detections that are no droplet known before."""
    widening: float = 1.0
    """By which squared errors of predictions are larger than thought."""

    def after(self, *, n_expected: int, n_paired: int, n_found: int, squared_distance: Column) -> "Scales":
        """With one more frame. `squared_distance` are those of pairs that are beyond doubt."""
        if n_expected < _LEAST_PAIRS or n_found < _LEAST_PAIRS:
            return self
        detected = _KEPT * self.detected + (1 - _KEPT) * n_paired / n_expected
        surprising = _KEPT * self.surprising + (1 - _KEPT) * (n_found - n_paired) / n_found
        widening = self.widening
        if len(squared_distance) >= _LEAST_PAIRS:
            seen = float(np.median(squared_distance)) / _MEDIAN_OF_SQUARES
            widening *= float(np.clip(seen, 0.1, 10.0)) ** _WIDENING_POWER
        return Scales(
            float(np.clip(detected, 0.3, 0.98)),
            float(np.clip(surprising, 0.03, 0.9)),
            float(np.clip(widening, 0.3, 30.0)),
        )
