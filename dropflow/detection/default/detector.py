"""The `default` detection, whole: clean the frame, look twice, accept, and say how sure each number is."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from dropflow.detection.contract import Detection, Frame, Image, Rejected, Step
from dropflow.detection.default.features import MATCH
from dropflow.detection.default.looks import FirstLook, at_droplets, first_look, look_at_known, look_near, second_look
from dropflow.detection.default.model import Model, default_model, probability_of
from dropflow.detection.default.predictions import best_near
from dropflow.detection.default.sightings import Sightings
from dropflow.droplets import Droplets
from dropflow.experiment import DropletTone
from dropflow.preprocess import StackEstimate, corrected, remove_stripes

Flags = npt.NDArray[np.bool_]

ACCEPTED = 0.45
"""Droplets are at least this likely; about half of the best F1, which is where that is reached."""
ACCEPTED_NEAR = 0.2
"""The same where one was predicted."""
_ENOUGH_KNOWN = 20
"""With fewer known droplets the frame is looked at anew, or it would not be known what is usual in it."""
_LEAST_STD_PX = 0.02
_WORTH_MEASURING, _WIDE = 0.1, 0.3


@dataclass(frozen=True, eq=False)
class DefaultDetector:
    """Finds droplets of `r_min_px` to `r_max_px` with what `model` has learnt."""

    estimate: StackEstimate
    tone: DropletTone
    r_min_px: float
    r_max_px: float
    model: Model = field(default_factory=default_model)

    def prepare(self, frame: Frame) -> Image:
        """Flat field, tone and stripes; grey levels as in the frame, droplets bright."""
        image = corrected(frame, self.estimate, self.tone)
        remove_stripes(image, self.estimate.stripes)
        return image

    def steps(self, frame: Frame) -> Iterator[Step]:
        """The flat field (and tone), then the stripes."""
        image = corrected(frame, self.estimate, self.tone)
        yield Step("flat_field", "divided by the flat field; dark droplets made bright", image.copy())
        remove_stripes(image, self.estimate.stripes)
        yield Step("stripes", "lines of light and shadow along the frame taken away", image)

    def detect(self, image: Image) -> Detection:
        """Look twice, accept what is likely, each droplet once."""
        return self.accepted(self.look(image)[1])

    def look(self, image: Image) -> tuple[FirstLook, Sightings]:
        """What the two looks at a prepared frame see, before anything is accepted."""
        first = first_look(image, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        return first, second_look(image, first, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)

    def accepted(self, seen: Sightings) -> Detection:
        """Those of the second look's sightings that are droplets, and why the others are none."""
        droplets = self._measured(seen)
        why_not = {
            "unlikely": droplets.probability < ACCEPTED,
            "duplicate": ~seen.best(droplets.probability),
            "radius": ~self._is_looked_for(droplets),
        }
        reasons = np.select(list(why_not.values()), list(why_not), default="")
        is_bad = reasons != ""
        return Detection(
            droplets[~is_bad], Rejected(droplets[is_bad], tuple(str(reason) for reason in reasons[is_bad]))
        )

    def find_near(self, image: Image, predicted: Droplets, known: Droplets) -> tuple[Droplets, Flags]:
        """Fit at each prediction beside the droplets that are sure, and take what is likely and like it."""
        if not len(predicted):
            return Droplets.empty(), np.empty(0, bool)
        places = at_droplets(predicted)
        if len(known) < _ENOUGH_KNOWN:
            first = first_look(image, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        else:
            first = look_at_known(image, known, places, self.model, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        seen = look_near(image, first, self.model, places, r_min_px=self.r_min_px, r_max_px=self.r_max_px)
        found, is_near = best_near(self._measured(seen), predicted)
        return found, is_near & (found.probability >= ACCEPTED_NEAR) & self._is_looked_for(found)

    def unfamiliar_share(self, image: Image) -> float:
        """Part of the features of this frame's droplets that is beyond what the model was trained on; 0 of none."""
        return self.unfamiliar_share_of(self.look(image)[1])

    def unfamiliar_share_of(self, seen: Sightings) -> float:
        """The same of what a second look saw."""
        is_likely = probability_of(self.model.again.predict(seen.features)) >= ACCEPTED
        return self.model.share_out_of_range(seen.features[is_likely])

    def _is_looked_for(self, droplets: Droplets) -> Flags:
        """Whether the radius may, within its standard deviation, be one of the range looked for."""
        is_big = droplets.r_px + droplets.r_std_px >= self.r_min_px
        return is_big & (droplets.r_px - droplets.r_std_px <= self.r_max_px)

    def _measured(self, seen: Sightings) -> Droplets:
        """Sightings with radius, uncertainties and probability from the model."""
        model = self.model
        probability = probability_of(model.again.predict(seen.features))
        # What is hardly a droplet keeps its fitted radius and gets a wide error: nobody uses either.
        is_worth = probability >= _WORTH_MEASURING
        features = seen.features[is_worth]
        r_px = seen.r_px.copy()
        r_px[is_worth] *= np.exp(model.radius.predict(features))
        x_std_px, r_std_px = _WIDE * seen.r_px, _WIDE * seen.r_px
        x_std_px[is_worth] = seen.r_px[is_worth] * np.exp(model.position_error.predict(features))
        r_std_px[is_worth] = r_px[is_worth] * np.exp(model.radius_error.predict(features))
        x_std_px, r_std_px = np.maximum(x_std_px, _LEAST_STD_PX), np.maximum(r_std_px, _LEAST_STD_PX)
        match = np.clip(seen.features[:, MATCH], 0.0, 1.0)
        return Droplets(seen.x_px, seen.y_px, r_px, x_std_px, r_std_px, probability, match)
