"""Parameters proposed from what is measured on a few frames: `suggest` gives an `Advice`."""

from dropflow.suggest.advice import Advice, Suggestion, suggest
from dropflow.suggest.displacement import Displacement, displacement
from dropflow.suggest.measurements import Measurement

__all__ = ["Advice", "Displacement", "Measurement", "Suggestion", "displacement", "suggest"]
