"""Looking at a frame twice: droplets that are sure after the first look are explained away before the second."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dropflow.detection.default.candidates import find_candidates
from dropflow.detection.default.closer import NO_OWN, NO_PROFILES, look_closer
from dropflow.detection.default.explain import explain_away
from dropflow.detection.default.features import SPREAD, VOTES
from dropflow.detection.default.model import Model, log_odds_of, probability_of
from dropflow.detection.default.overlaps import context
from dropflow.detection.default.pyramid import Level, pyramid
from dropflow.detection.default.rays import N_PROFILE
from dropflow.detection.default.sightings import Rows, Sightings
from dropflow.detection.default.usual import Usual, relate_to_frame, usual_of
from dropflow.droplets import Droplets
from dropflow.preprocess import noise_level

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

FIRST_FINEST_PX, SECOND_FINEST_PX = 10.4, 5.2
"""The second look works at half the size: what is left then stands apart."""
LEAST_VOTES = 0.22
_CLEAR_VOTES = 0.5
SURE = 0.5
"""Probability from which the first look's droplets are explained away."""
DOUBTFUL = 0.1
"""Candidates of the first look below this are not looked at again."""
_BATCH, _BATCH_PER_MPIXEL = 300, 140
_LEAST_YIELD = 0.1
"""Candidates are looked at in batches, those with most votes first, until less than this share of one is sure."""
_MOST_BATCHES = 12
_TRAINING_BATCHES = 3
_N_ITERATIONS, _N_FROM_AFAR = 2, 3
"""Votes and first looks are near enough that fits begin with the second of the three iterations; predictions not."""
_LEAST_ODDS = 1e-5
_NEAR = 4.0
"""Droplets farther from all predictions than this many of the largest radii change nothing that is measured there."""
_MOST_SPREAD = 0.25
_LEAST_SHARE, _MOST_SHARE = 0.6, 1.25
"""Fitted edges may leave the range of radii looked for this far: the true radius is another one."""


@dataclass(frozen=True, eq=False)
class FirstLook:
    """What the first look at a frame gives."""

    noise: float
    usual: Usual
    sightings: Sightings

    def log_odds(self, model: Model) -> Column:
        """Of being a droplet, of each sighting: those of the look itself, or of another model."""
        known = self.sightings.first_log_odds
        return known if np.isfinite(known).all() else model.first.predict(self.sightings.features)


def first_look(image: Image, model: Model | None, *, r_min_px: float, r_max_px: float) -> FirstLook:
    """Find, fit and measure candidates in a prepared frame, shape (rows, columns) float32.

    Without a model (which is when one is trained) a fixed number of candidates is looked at.
    """
    look = _Look(pyramid(image, r_max_px), noise_level(image), r_min_px, r_max_px, usual=None)
    seen = look.around(model, FIRST_FINEST_PX)
    return FirstLook(look.noise, look.usual or usual_of(seen.features, image, look.noise), seen)


def at_droplets(droplets: Droplets) -> Sightings:
    """Where droplets are known or predicted to be. Nobody voted for them: they get the votes of clear droplets."""
    votes = np.full(len(droplets), _CLEAR_VOTES)
    return Sightings.unmeasured(droplets.x_px, droplets.y_px, droplets.r_px, votes)


def look_at_known(
    image: Image, known: Droplets, places: Sightings, model: Model, *, r_min_px: float, r_max_px: float
) -> FirstLook:
    """As `first_look`, but at droplets that were found in this frame before, and at these places.

    Radii of `Droplets` are those of the model, not those of the edges, so known droplets are fitted again. They also
    say what is usual in the frame. What is left is what may matter to a droplet at one of the places.
    """
    look = _Look(pyramid(image, r_max_px), noise_level(image), r_min_px, r_max_px, usual=None)
    start = at_droplets(known)
    start.first_log_odds[:] = log_odds_of(np.clip(known.probability, _LEAST_ODDS, 1 - _LEAST_ODDS))
    again = look.closer(start)
    new = look.closer(places, n_iterations=_N_FROM_AFAR)
    new.first_log_odds[:] = model.first.predict(new.features)
    both = again.followed_by(new)
    nearest, _ = cKDTree(places.circles()[:, :2]).query(both.circles()[:, :2])
    usual = look.usual or usual_of(again.features, image, look.noise)
    return FirstLook(look.noise, usual, both[nearest <= _NEAR * r_max_px])


def second_look(image: Image, first: FirstLook, model: Model, *, r_min_px: float, r_max_px: float) -> Sightings:
    """Explain the sure droplets away, fit each again beside the others, and find what they hid.

    Returns sightings with features `dropflow.detection.default.model.AGAIN`.
    """
    rest = _Rest.of(image, first, model, r_min_px=r_min_px, r_max_px=r_max_px)
    hidden = rest.look.around(model, SECOND_FINEST_PX)
    return rest.with_sure(hidden.followed_by(rest.look.closer(rest.doubtful)).unique())


def look_near(
    image: Image, first: FirstLook, model: Model, places: Sightings, *, r_min_px: float, r_max_px: float
) -> Sightings:
    """As `second_look`, but beside the sure droplets only what is at these places."""
    rest = _Rest.of(image, first, model, r_min_px=r_min_px, r_max_px=r_max_px)
    return rest.with_sure(rest.look.closer(places, n_iterations=_N_FROM_AFAR))


@dataclass(frozen=True, eq=False)
class _Rest:
    """What is left of an image without its sure droplets, and they beside it."""

    look: "_Look"
    sure: Sightings
    profiles: Image
    log_odds: Column
    """Of the sure ones."""
    doubtful: Sightings

    @staticmethod
    def of(image: Image, first: FirstLook, model: Model, *, r_min_px: float, r_max_px: float) -> "_Rest":
        """Explain away what the first look took for sure."""
        probability = probability_of(first.log_odds(model))
        is_sure = (probability > SURE) & first.sightings.best(probability)
        order = np.flatnonzero(is_sure)[np.argsort(-probability[is_sure], kind="stable")]
        sure = first.sightings[order]
        profiles = np.zeros((len(sure), N_PROFILE), np.float32)
        rest = image.copy()
        explain_away(rest, sure.x_px, sure.y_px, sure.r_px, profiles)
        look = _Look(pyramid(rest, r_max_px), first.noise, r_min_px, r_max_px, first.usual)
        doubtful = first.sightings[(probability > DOUBTFUL) & (probability <= SURE)]
        return _Rest(look, sure, profiles, log_odds_of(probability[order]), doubtful)

    def with_sure(self, found: Sightings) -> Sightings:
        """The sure droplets fitted again, each put back alone, and what was found beside them."""
        own = self.sure.circles()
        refitted = self.look.fitted(self.sure, own, self.profiles)
        again = _with_context(refitted, own, np.arange(len(own), dtype=np.int64), self.log_odds)
        new = _with_context(found, own, np.full(len(found), -1, np.int64), np.full(len(found), np.nan))
        both = again.followed_by(new)
        return both[np.isfinite(both.features[:, SPREAD])]


@dataclass(eq=False)
class _Look:
    """One look at one image."""

    levels: list[Level]
    noise: float
    r_min_px: float
    r_max_px: float
    usual: Usual | None

    def around(self, model: Model | None, finest_px: float) -> Sightings:
        """Candidates all over the image, those with most votes first, as long as enough of them are sure."""
        found = find_candidates(
            self.levels,
            self.noise,
            r_min_px=self.r_min_px,
            r_max_px=self.r_max_px,
            finest_px=finest_px,
            least_votes=LEAST_VOTES,
        )
        start = Sightings.unmeasured(found.x_px, found.y_px, found.r_px, found.votes).apart()
        size = _BATCH + _BATCH_PER_MPIXEL * self.levels[0].image.size // 1_000_000
        n_batches = _TRAINING_BATCHES if model is None else _MOST_BATCHES
        order = np.argsort(-start.features[:, VOTES], kind="stable")[: n_batches * size]
        seen = start[:0]
        for begin in range(0, len(order), size):
            batch = self.closer(start[order[begin : begin + size]])
            n_before, seen = len(seen), seen.followed_by(batch).unique()
            if model is None:
                continue
            # What was seen before had more votes, so it is all still there.
            log_odds = model.first.predict(seen.features[n_before:])
            seen.first_log_odds[n_before:] = log_odds
            if np.count_nonzero(probability_of(log_odds) > SURE) < _LEAST_YIELD * size:
                break
        return seen

    def closer(self, start: Sightings, *, n_iterations: int = _N_ITERATIONS) -> Sightings:
        """Those of the sightings that are circles of a radius looked for, inside the frame."""
        seen = self.fitted(start, NO_OWN, NO_PROFILES, n_iterations=n_iterations)
        rows, columns = self.levels[0].image.shape
        is_right = seen.features[:, SPREAD] < _MOST_SPREAD
        is_right &= (seen.r_px > _LEAST_SHARE * self.r_min_px) & (seen.r_px < _MOST_SHARE * self.r_max_px)
        is_right &= (seen.x_px >= -0.5) & (seen.y_px >= -0.5)
        is_right &= (seen.x_px < columns - 0.5) & (seen.y_px < rows - 0.5)
        return seen[is_right]

    def fitted(self, start: Sightings, own: Column, profiles: Image, *, n_iterations: int = _N_ITERATIONS) -> Sightings:
        """All sightings fitted and measured; `own` and `profiles` as in `look_closer`."""
        x, y, r, features = look_closer(
            self.levels,
            self.noise,
            start.x_px,
            start.y_px,
            start.r_px,
            n_iterations=n_iterations,
            own=own,
            profiles=profiles,
        )
        if self.usual is None:
            self.usual = usual_of(features, self.levels[0].image, self.noise)
        relate_to_frame(features, self.usual)
        features[:, VOTES] = start.features[:, VOTES]
        return Sightings(x, y, r, features, start.first_log_odds.copy())


def _with_context(seen: Sightings, sure: Column, own: Rows, log_odds: Column) -> Sightings:
    around = context(seen.x_px, seen.y_px, seen.r_px, sure, own)
    features = np.column_stack([seen.features, around, log_odds])
    return Sightings(seen.x_px, seen.y_px, seen.r_px, features, seen.first_log_odds)
