"""One assignment a frame: how probable it is that a predicted droplet is a detected one."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, Pairs, in_both
from dropflow.tracking.probable.candidates import pair_probabilities, possible_pairs
from dropflow.tracking.probable.expectation import Predicted

_N_RADIUS_BINS = 48
_RADIUS_BLUR = 0.15
"""Standard deviation, in ln r, of the kernel with which the distribution of radii is estimated."""


@dataclass(frozen=True)
class Chances:
    """What a pair competes with."""

    detected: float
    """Probability that a droplet that is there is detected."""
    surprise_per_px2: float
    """Density of detections that are no known droplet."""


@dataclass(frozen=True)
class Association:
    """Possible pairs; each attribute of shape (n_pairs,)."""

    first: Indices
    """Into the predicted droplets."""
    second: Indices
    """Into the detected ones."""
    probability: Column
    """That the two are one droplet, all other possibilities weighed."""
    squared_distance: Column
    """Mahalanobis distance of the places, squared; 2 on average for right pairs whose errors are well known."""

    def is_taken(self) -> npt.NDArray[np.bool_]:
        """Pairs more probable than not; each droplet is in one of them at most."""
        return self.probability > 0.5

    @cached_property
    def taken(self) -> Indices:
        """The pairs that are taken; `first` is ascending."""
        return np.flatnonzero(self.is_taken())

    def pairs(self) -> Pairs:
        """The pairs that are taken, `first` ascending."""
        return Pairs(self.first[self.taken], self.second[self.taken])

    def of(self, pairs: Pairs, values: Column, otherwise: float) -> Column:
        """Of `values` (one a possible pair) those of `pairs`; `otherwise` for a pair that was not taken."""
        known = self.first[self.taken]
        both = in_both(known, pairs.first)
        chosen = np.full(len(pairs), otherwise)
        chosen[both.second] = values[self.taken[both.first]]
        return chosen


def associate(predicted: Predicted, found: Droplets, chances: Chances) -> Association:
    """Weigh all pairs of predicted and found droplets that are not out of the question.

    A pair's likelihood is that of the distance under the errors of prediction and detection, times that of the ratio
    of radii, over the density of surprising detections of this size. Belief propagation turns likelihoods into the
    probabilities of pairs in a world where each droplet is detected once at most and each detection is one droplet
    at most (J. Williams and R. Lau, IEEE Trans. Aerosp. Electron. Syst. 50 (2014) 2942-2959).
    """
    if not len(predicted.droplets) or not len(found):
        nothing = np.empty(0, np.int64)
        return Association(nothing, nothing, np.empty(0), np.empty(0))
    log_r = np.log(found.r_px)
    log_odds = np.log(chances.detected / (1 - chances.detected) / chances.surprise_per_px2)
    place = predicted.droplets
    first, second, log_weight, squared = possible_pairs(
        np.stack(
            [
                place.x_px,
                place.y_px,
                predicted.across_variance,
                predicted.along_variance,
                np.log(place.r_px),
                predicted.log_r_std**2,
            ]
        ),
        np.stack([found.x_px, found.y_px, found.x_std_px**2, log_r, (found.r_std_px / found.r_px) ** 2]),
        log_odds - log_radius_density(log_r),
        predicted.up,
    )
    probability = pair_probabilities(first, second, log_weight, len(place), len(found))
    return Association(first, second, probability, squared)


def log_radius_density(log_r: Column) -> Column:
    """Logarithm of the density of ln r at each of these, estimated from them."""
    low, high = log_r.min() - 3 * _RADIUS_BLUR, log_r.max() + 3 * _RADIUS_BLUR
    width = (high - low) / _N_RADIUS_BINS
    bins = np.minimum(((log_r - low) / width).astype(np.int64), _N_RADIUS_BINS - 1)
    counts = np.bincount(bins, minlength=_N_RADIUS_BINS) / (len(log_r) * width)
    reach = int(np.ceil(3 * _RADIUS_BLUR / width))
    kernel = np.exp(-((np.arange(-reach, reach + 1) * width) ** 2) / (2 * _RADIUS_BLUR**2))
    density = np.convolve(counts, kernel / kernel.sum(), mode="full")[reach : reach + _N_RADIUS_BINS]
    return np.asarray(np.log(density[bins]))
