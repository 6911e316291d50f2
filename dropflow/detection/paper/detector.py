"""The paper's detection, whole: prepared frame, both strategies, duplicates, match (sections 3.1.1 to 3.1.3)."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection.contract import Detection, Frame, Image, Rejected, Step
from dropflow.detection.paper.circles import Circles
from dropflow.detection.paper.confidence import position_std_px, probability, radius_std_px
from dropflow.detection.paper.contrast import black_and_white
from dropflow.detection.paper.duplicates import is_similar, is_unique
from dropflow.detection.paper.match import climb, match
from dropflow.detection.paper.thresholding import background_level, find_by_threshold, threshold_levels
from dropflow.detection.paper.watershed import find_by_watershed
from dropflow.droplets import Droplets
from dropflow.experiment import DropletTone
from dropflow.parameters import PaperDetection
from dropflow.preprocess import Blur, StackEstimate, band_pass, corrected, noise_std, stretch

Flags = npt.NDArray[np.bool_]

HALVED_FROM_PX = 6.0
"""Candidates are looked for on a frame of half the size where the smallest radius is at least this: four times less
work, and the match then finds the place on the whole frame."""


@dataclass(frozen=True)
class PaperDetector:
    """Sections 3.1.1 to 3.1.3 with the constants `knobs`, for droplets of `r_min_px` to `r_max_px`."""

    estimate: StackEstimate
    tone: DropletTone
    r_min_px: float
    r_max_px: float
    knobs: PaperDetection

    def prepare(self, frame: Frame) -> Image:
        """Flat field, band pass, contrast: levels 0 to 255, droplets bright (section 3.1.1)."""
        image = corrected(frame, self.estimate, self.tone)
        return self._contrasted(self._filtered(image), image)

    def steps(self, frame: Frame) -> Iterator[Step]:
        """The flat field (and tone), the band pass, and the contrast."""
        image = corrected(frame, self.estimate, self.tone)
        yield Step("flat_field", "divided by the flat field; dark droplets made bright", image)
        filtered = self._filtered(image)
        yield Step("band_pass", "what is wider than droplets, stripes and noise filtered away", filtered.copy())
        yield Step("contrast", "levels stretched to 0 to 255", self._contrasted(filtered, image))

    def _filtered(self, image: Image) -> Image:
        high_pass, low_pass = self.blurs()
        return band_pass(image, high_pass=high_pass, low_pass=low_pass)

    def _contrasted(self, filtered: Image, image: Image) -> Image:
        """Stretch `filtered`, which was made of `image`, in place."""
        brightest = max(abs(float(image.min())), abs(float(image.max())))
        noise = noise_std(filtered, apart_px=self.r_min_px, blur_px=self.blurs()[1].sigma_x)
        black, white = black_and_white(filtered, noise=noise, knobs=self.knobs)
        return stretch(filtered, black=black, white=white, reference=brightest)

    def blurs(self) -> tuple[Blur, Blur]:
        """The high pass and the low pass of section 3.1.1 for frames of this shape and droplets of these radii."""
        knobs, shape = self.knobs, self.estimate.shape
        high = Blur.from_fourier(shape, knobs.high_pass_x, knobs.high_pass_y)
        low = Blur.from_fourier(shape, knobs.low_pass, knobs.low_pass)
        widest = knobs.low_pass_radii * self.r_min_px
        return (
            Blur(max(high.sigma_x, knobs.high_pass_radii * self.r_max_px), high.sigma_y),
            Blur(min(low.sigma_x, widest), min(low.sigma_y, widest)),
        )

    def detect(self, image: Image) -> Detection:
        """Find droplets by both strategies, merge duplicates, climb to the best match and judge it."""
        candidates = self.candidates(image)
        at_start = match(image, candidates.x_px, candidates.y_px, candidates.r_px, knobs=self.knobs)
        first = self._droplets(candidates, at_start)
        is_first = is_unique(first.x_px, first.y_px, first.r_px, first.match, knobs=self.knobs)
        climbed = self._climbed(image, candidates[is_first])
        # Different starts may have climbed to one droplet, hence duplicates are looked for once more.
        is_second = is_unique(climbed.x_px, climbed.y_px, climbed.r_px, climbed.match, knobs=self.knobs)
        is_match = climbed.match > self.knobs.minimum_match
        why_not = {"duplicate": ~is_second, "radius": ~self._is_looked_for(climbed), "match": ~is_match}
        reasons = np.select(list(why_not.values()), list(why_not), default="")
        is_bad = reasons != ""
        told = ("duplicate",) * int(np.count_nonzero(~is_first)) + tuple(str(reason) for reason in reasons[is_bad])
        rejected = Rejected(Droplets.concatenate([first[~is_first], climbed[is_bad]]), told)
        return Detection(climbed[~is_bad], rejected)

    def candidates(self, image: Image) -> Circles:
        """Circles of both strategies (section 3.1.2): thresholds for small and for big droplets, and watershed."""
        factor = 2 if self.r_min_px >= HALVED_FROM_PX else 1
        small = image if factor == 1 else _halved(image)
        # A strategy's radius is a first guess: it may leave the range as far as a similar radius goes.
        r_min_px = self.r_min_px * self.knobs.similar_ratio_min / factor
        r_max_px = self.r_max_px * self.knobs.similar_ratio_max / factor
        noise = noise_std(small, apart_px=self.r_min_px / factor, blur_px=self.blurs()[1].sigma_x / factor)
        levels = threshold_levels(background_level(small), noise, self.knobs)
        found = [find_by_threshold(small, level, r_min_px=r_min_px, r_max_px=r_max_px) for level in levels]
        height = max(self.knobs.maxima_height, self.knobs.noise_margin * noise)
        found.append(find_by_watershed(small, maxima_height=height, r_min_px=r_min_px, r_max_px=r_max_px))
        return Circles.concatenate(found).enlarged(factor)

    def find_near(
        self,
        image: Image,
        predicted: Droplets,
        known: Droplets,  # noqa: ARG002 - the paper climbs from the prediction alone
    ) -> tuple[Droplets, Flags]:
        """Climb from each prediction to the best match near it (section 3.3.1).

        It is taken for the predicted droplet when its match is above the minimum, it lies within `search_walk`
        predicted radii of the prediction, and its radius is in the range looked for and similar to the predicted one.
        A droplet predicted outside the frame is not found there, and its match is 0.
        """
        found = self._climbed(image, Circles(predicted.x_px, predicted.y_px, predicted.r_px))
        walk = np.hypot(found.x_px - predicted.x_px, found.y_px - predicted.y_px)
        is_good = (found.match > self.knobs.minimum_match) & (walk <= self.knobs.search_walk * predicted.r_px)
        is_good &= is_similar(found.r_px, predicted.r_px, self.knobs)
        return found, is_good & self._is_looked_for(found)

    def _is_looked_for(self, droplets: Droplets) -> Flags:
        """Whether the radius may, within its standard deviation, be one of the range looked for."""
        is_big = droplets.r_px + droplets.r_std_px >= self.r_min_px
        return is_big & (droplets.r_px - droplets.r_std_px <= self.r_max_px)

    def _climbed(self, image: Image, circles: Circles) -> Droplets:
        """Droplets where the match is at its local maximum."""
        low = self.r_min_px * self.knobs.similar_ratio_min
        high = self.r_max_px * self.knobs.similar_ratio_max
        x, y, r, best = climb(
            image, circles.x_px, circles.y_px, circles.r_px, r_low_px=low, r_high_px=high, knobs=self.knobs
        )
        return self._droplets(Circles(x, y, r), best)

    def _droplets(self, circles: Circles, matches: npt.NDArray[np.float64]) -> Droplets:
        """Circles with their match and what it says of their certainty."""
        finite = np.where(np.isfinite(matches), matches, 0.0)
        r_px = circles.r_px
        x_std, r_std = position_std_px(r_px), radius_std_px(r_px)
        return Droplets(circles.x_px, circles.y_px, r_px, x_std, r_std, probability(finite), finite)


def _halved(image: Image) -> Image:
    return np.asarray(cv2.resize(image, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), np.float32)
