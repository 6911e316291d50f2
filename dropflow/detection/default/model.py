"""What was learnt of droplets: trees that say how likely a candidate is one, its radius, and how sure that is.

Grown by ``python -m dropflow.detection.default.training`` on simulated frames, stored in ``model.npz`` beside this.
"""

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.features import FEATURES
from dropflow.detection.default.overlaps import CONTEXT
from dropflow.detection.default.trees import Trees

Column = npt.NDArray[np.float64]

MODEL_FILE = Path(__file__).with_name("model.npz")
AGAIN = (*FEATURES, *CONTEXT, "first_log_odds")
"""Features of the second look; `first_log_odds` is missing for candidates that the first look did not take for sure."""
_PARTS = ("first", "again", "radius", "radius_error", "position_error")
_MOST_ODDS = 12.0


@dataclass(frozen=True, eq=False)
class Model:
    """Five sums of trees, and what they were grown on."""

    first: Trees
    """Features of the first look to log odds."""
    again: Trees
    """Features of the second look to log odds."""
    radius: Trees
    """To ln(true radius / fitted radius)."""
    radius_error: Trees
    """To ln of the error of ln(radius) that 68 % do not exceed."""
    position_error: Trees
    """To ln of the error of either coordinate, over the radius, that 68 % do not exceed."""
    low: Column
    """Lower ends of the ranges of `AGAIN` seen in training."""
    high: Column
    about: dict[str, Any]
    """Version, how it was trained, what it reached."""

    def share_out_of_range(self, features: Column) -> float:
        """Mean share of features (shape (n, len(AGAIN))) beyond what was seen in training; 0 of none."""
        if len(features) == 0:
            return 0.0
        return float(np.mean((features < self.low) | (features > self.high)))

    def save(self, file: Path) -> None:
        """Write all of this as an .npz archive without pickles."""
        arrays: dict[str, Any] = {"low": self.low.astype(np.float32), "high": self.high.astype(np.float32)}
        for part in _PARTS:
            arrays |= getattr(self, part).to_arrays(part)
        about = self.about | {"features": AGAIN}
        np.savez_compressed(file, about=np.array(json.dumps(about)), **arrays)


def load(file: Path = MODEL_FILE) -> Model:
    """Read what `Model.save` wrote."""
    with np.load(file, allow_pickle=False) as archive:
        arrays = dict(archive)
    about = json.loads(str(arrays["about"]))
    if tuple(about["features"]) != AGAIN:
        raise ValueError(f"{file} was trained on other features: run python -m dropflow.detection.default.training")
    trees = {part: Trees.from_arrays(arrays, part) for part in _PARTS}
    low, high = (arrays[end].astype(np.float64) for end in ("low", "high"))
    return Model(**trees, low=low, high=high, about=about)


@lru_cache(maxsize=1)
def default_model() -> Model:
    """The model that comes with this package."""
    return load()


def probability_of(log_odds: Column) -> Column:
    """Probabilities of log odds."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(log_odds, -_MOST_ODDS, _MOST_ODDS))))


def log_odds_of(probability: Column) -> Column:
    """Log odds of probabilities."""
    return np.asarray(np.log(probability / (1.0 - probability)))
