"""Learning which sightings are droplets, and how far the probabilities hold on scenes that were not learnt from."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.model import probability_of
from dropflow.detection.default.training.growing import classifier_trees, scaled
from dropflow.detection.default.training.samples import Samples
from dropflow.detection.default.trees import Trees

Column = npt.NDArray[np.float64]

_N_AGAIN = 200
_WEIGHTS = {"empty": 2.0}
"""Scenes that count for more than one."""


def classifier_of(samples: Sequence[Samples], *, n_trees: int, seed: int) -> Trees:
    """Trees grown on all sightings that are right or wrong."""
    features = np.concatenate([some.sightings.features for some in samples])
    labels = np.concatenate([some.is_droplet for some in samples])
    weight = np.concatenate([np.full(len(some.is_droplet), _WEIGHTS.get(some.family, 1.0)) for some in samples])
    counts = np.isfinite(labels)
    return classifier_trees(features[counts], labels[counts], weight[counts], n_trees=n_trees, seed=seed)


def acceptance_trees(seen: Sequence[Samples], folds: npt.NDArray[np.int64], seed: int) -> tuple[Trees, list[Column]]:
    """Calibrated trees, and the calibrated log odds in each scene by trees that have not seen it."""
    log_odds: list[Column] = [np.empty(0)] * len(seen)
    for fold in np.unique(folds):
        others = [samples for samples, other in zip(seen, folds, strict=True) if other != fold]
        trees = classifier_of(others, n_trees=_N_AGAIN, seed=seed)
        for index in np.flatnonzero(folds == fold).tolist():
            log_odds[index] = trees.predict(seen[index].sightings.features)
    factor, shift = _platt(*_of_single(log_odds, seen))
    trees = scaled(classifier_of(seen, n_trees=_N_AGAIN, seed=seed), factor, shift)
    return trees, [factor * column + shift for column in log_odds]


def calibration(name: str, log_odds: Sequence[Column], seen: Sequence[Samples]) -> str:
    """Of what was given about so much probability by trees that had not seen it, how much is a droplet."""
    odds, is_droplet = _of_single(log_odds, seen)
    probability = probability_of(odds)
    lines = [f"{name}: {int(is_droplet.sum())} of {len(is_droplet)} are droplets"]
    for low in np.arange(0, 1, 0.1):
        of_bin = (probability >= low) & (probability < low + 0.1)
        if of_bin.any():
            lines.append(f"  {low + 0.05:.2f}: {is_droplet[of_bin].mean():.3f} of {int(of_bin.sum())}")
    return "\n".join(lines)


def _of_single(log_odds: Sequence[Column], seen: Sequence[Samples]) -> tuple[Column, Column]:
    """Log odds and labels, without doubles, of which only the likeliest is ever reported."""
    is_kept = np.concatenate([some.sightings.best(odds) for odds, some in zip(log_odds, seen, strict=True)])
    is_droplet = np.concatenate([some.is_droplet for some in seen])
    is_kept &= np.isfinite(is_droplet)
    return np.concatenate(log_odds)[is_kept], is_droplet[is_kept]


def _platt(log_odds: Column, is_droplet: Column) -> tuple[float, float]:
    """Factor and shift that make log odds those of the labels (logistic regression)."""
    from sklearn.linear_model import LogisticRegression

    fit = LogisticRegression(C=1e6).fit(log_odds[:, None], is_droplet)
    return float(fit.coef_[0, 0]), float(fit.intercept_[0])
