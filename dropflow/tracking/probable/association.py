"""One assignment a frame: how probable it is that a predicted droplet is a detected one."""

from dataclasses import dataclass
from math import lgamma, log, pi

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, Pairs, neighbours
from dropflow.tracking.probable.directions import turned
from dropflow.tracking.probable.expectation import Predicted
from dropflow.tracking.probable.observing import TAIL

_REACH_STD = 4.5
"""A detection further from its prediction than this many standard deviations is not thought of."""
_RADIUS_MODEL_STD = 0.03
"""Standard deviation of ln r between frames beyond its known errors."""
_N_RADIUS_BINS = 48
_RADIUS_BLUR = 0.15
"""Standard deviation, in ln r, of the kernel with which the distribution of radii is estimated."""
_MOST_ROUNDS = 25
_CONVERGED = 1e-3
_LEAST_LOG_ODDS = -6.0
"""Pairs less probable than this against chance are left out."""
_MOST_LOG_ODDS = 20.0


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

    def pairs(self) -> Pairs:
        """The pairs that are taken, `first` ascending."""
        taken = np.flatnonzero(self.is_taken())
        order = taken[np.argsort(self.first[taken], kind="stable")]
        return Pairs(self.first[order], self.second[order])

    def of(self, pairs: Pairs, values: Column, otherwise: float) -> Column:
        """Of `values` (one a possible pair) those of `pairs`; `otherwise` for a pair that was not thought of."""
        taken = self.is_taken()
        by_first = dict(zip(self.first[taken].tolist(), values[taken].tolist(), strict=True))
        return np.array([by_first.get(first, otherwise) for first in pairs.first.tolist()])


def associate(predicted: Predicted, found: Droplets, chances: Chances) -> Association:
    """Weigh all pairs of predicted and found droplets that are not out of the question.

    A pair's likelihood is that of the distance under the errors of prediction and detection, times that of the ratio
    of radii, over the density of surprising detections of this size. Belief propagation turns likelihoods into the
    probabilities of pairs in a world where each droplet is detected once at most and each detection is one droplet
    at most (J. Williams and R. Lau, IEEE Trans. Aerosp. Electron. Syst. 50 (2014) 2942-2959).
    """
    reach_px = _REACH_STD * np.sqrt(np.maximum(predicted.across_variance, predicted.along_variance)) + 1.0
    near = neighbours(predicted.droplets, found, reach_px)
    first, second = near.first, near.second
    squared, log_density = _place_likelihood(predicted, found, first, second)
    log_radius = _radius_likelihood(predicted, found, first, second)
    log_surprise = np.log(chances.surprise_per_px2) + log_radius_density(found.r_px)[second]
    odds = np.log(chances.detected / (1 - chances.detected))
    log_weight = log_density + log_radius + odds - log_surprise
    is_possible = (log_weight > _LEAST_LOG_ODDS) & (squared < _REACH_STD**2 * 2)
    first, second, log_weight = first[is_possible], second[is_possible], log_weight[is_possible]
    probability = pair_probabilities(first, second, log_weight, len(predicted.droplets), len(found))
    return Association(first, second, probability, squared[is_possible])


def pair_probabilities(first: Indices, second: Indices, log_weight: Column, n_first: int, n_second: int) -> Column:
    """Probability of each pair from its log odds against both ends being alone.

    For each end the probabilities of its pairs sum to one at most.
    """
    weight = np.exp(np.minimum(log_weight, _MOST_LOG_ODDS))
    message = np.ones(len(weight))
    for _ in range(_MOST_ROUNDS):
        product = weight * message
        others = np.maximum(np.bincount(first, product, n_first)[first] - product, 0.0)
        claim = weight / (1 + others)
        rivals = np.maximum(np.bincount(second, claim, n_second)[second] - claim, 0.0)
        updated = 1 / (1 + rivals)
        has_converged = not len(weight) or np.abs(updated - message).max() < _CONVERGED
        message = updated
        if has_converged:
            break
    product = weight * message
    return np.asarray(product / (1 + np.bincount(first, product, n_first)[first]))


def log_radius_density(r_px: Column) -> Column:
    """Logarithm of the density of ln r at each of these radii, estimated from them."""
    if not len(r_px):
        return np.empty(0)
    log_r = np.log(r_px)
    low, high = log_r.min() - 3 * _RADIUS_BLUR, log_r.max() + 3 * _RADIUS_BLUR
    edges = np.linspace(low, high, _N_RADIUS_BINS + 1)
    width = edges[1] - edges[0]
    counts = np.histogram(log_r, edges)[0] / (len(log_r) * width)
    reach = int(np.ceil(3 * _RADIUS_BLUR / width))
    kernel = np.exp(-((np.arange(-reach, reach + 1) * width) ** 2) / (2 * _RADIUS_BLUR**2))
    density = np.convolve(counts, kernel / kernel.sum(), mode="full")[reach : reach + _N_RADIUS_BINS]
    bins = np.minimum(((log_r - low) / width).astype(np.int64), _N_RADIUS_BINS - 1)
    return np.asarray(np.log(density[bins]))


def _place_likelihood(predicted: Predicted, found: Droplets, first: Indices, second: Indices) -> tuple[Column, Column]:
    """Squared Mahalanobis distances and log densities, per px^2, of two-dimensional t distributions."""
    expected = predicted.droplets
    off_x, off_y = found.x_px[second] - expected.x_px[first], found.y_px[second] - expected.y_px[first]
    across, along = turned(off_x, off_y, predicted.up)
    detection = found.x_std_px[second] ** 2
    across_variance = predicted.across_variance[first] + detection
    along_variance = predicted.along_variance[first] + detection
    squared = across**2 / across_variance + along**2 / along_variance
    log_peak = -np.log(2 * np.pi) - np.log(across_variance * along_variance) / 2
    return np.asarray(squared), np.asarray(log_peak - (TAIL / 2 + 1) * np.log1p(squared / TAIL))


def _radius_likelihood(predicted: Predicted, found: Droplets, first: Indices, second: Indices) -> Column:
    """Log densities, per unit of ln r, of t distributions."""
    log_ratio = np.log(found.r_px[second] / predicted.droplets.r_px[first])
    found_std = found.r_std_px[second] / found.r_px[second]
    variance = predicted.log_r_std[first] ** 2 + found_std**2 + _RADIUS_MODEL_STD**2
    return log_t_density(log_ratio, variance)


def log_t_density(off: Column, variance: Column) -> npt.NDArray[np.float64]:
    """Log density of a t distribution whose core has this variance."""
    log_norm = lgamma((TAIL + 1) / 2) - lgamma(TAIL / 2) - log(TAIL * pi) / 2
    return np.asarray(log_norm - np.log(variance) / 2 - (TAIL + 1) / 2 * np.log1p(off**2 / variance / TAIL))
