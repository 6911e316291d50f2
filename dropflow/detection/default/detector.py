"""The `default` detection, whole: clean the frame, look twice, accept, and say how sure each number is."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from dropflow.detection.contract import Detection, Frame, Image, Rejected
from dropflow.detection.default.cleaning import StripeEstimate, cleaned
from dropflow.detection.default.features import MATCH
from dropflow.detection.default.looks import Sightings, first_look, second_look
from dropflow.detection.default.model import Model, default_model, probability_of
from dropflow.droplets import Droplets
from dropflow.experiment import DropletTone
from dropflow.preprocess import StackEstimate, corrected

Column = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

ACCEPTED = 0.45
"""Droplets are at least this likely; about half of the best F1, which is where that is reached."""
ACCEPTED_NEAR = 0.2
"""The same where one was predicted."""
_WALK, _RATIO = 0.7, 1.35
"""A droplet looked for near a prediction is within this many predicted radii, with a radius within this factor."""
_LEAST_STD_PX = 0.02


@dataclass(frozen=True, eq=False)
class DefaultDetector:
    """Finds droplets of `r_min_px` to `r_max_px` with what `model` has learnt."""

    estimate: StackEstimate
    stripes: StripeEstimate
    tone: DropletTone
    r_min_px: float
    r_max_px: float
    model: Model = field(default_factory=default_model)

    def prepare(self, frame: Frame) -> Image:
        """Flat field, tone and stripes; grey levels as in the frame, droplets bright."""
        return cleaned(corrected(frame, self.estimate, self.tone), self.stripes)

    def detect(self, image: Image) -> Detection:
        """Look twice, accept what is likely, each droplet once."""
        first = first_look(image, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        seen = second_look(image, first, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        droplets = self._measured(seen)
        is_single = seen.best(droplets.probability)
        is_range = (droplets.r_px >= self.r_min_px) & (droplets.r_px <= self.r_max_px)
        is_likely = droplets.probability >= ACCEPTED
        reasons = np.select([~is_likely, ~is_single, ~is_range], ["unlikely", "duplicate", "radius"], default="")
        is_bad = reasons != ""
        return Detection(droplets[~is_bad], Rejected(droplets[is_bad], tuple(str(reason) for reason in reasons[is_bad])))

    def _measured(self, seen: Sightings) -> Droplets:
        """Sightings with radius, uncertainties and probability from the model."""
        model = self.model
        probability = probability_of(model.again.predict(seen.features))
        r_px = seen.r_px * np.exp(model.radius.predict(seen.features))
        x_std = seen.r_px * np.exp(model.position_error.predict(seen.features))
        r_std = r_px * np.exp(model.radius_error.predict(seen.features))
        match = np.clip(seen.features[:, MATCH], 0.0, 1.0)
        least = _LEAST_STD_PX
        return Droplets(seen.x_px, seen.y_px, r_px, np.maximum(x_std, least), np.maximum(r_std, least), probability, match)
