"""Learning the true radius from the fitted one, and how far off radius and place are."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.training.growing import regressor_trees, scaled
from dropflow.detection.default.training.samples import Samples
from dropflow.detection.default.training.scenes import Scene
from dropflow.detection.default.trees import Trees

Column = npt.NDArray[np.float64]
Folds = npt.NDArray[np.int64]

_ONE_SIGMA = 0.683
_GOOD_FIT = 0.5
"""Sightings with less cost than this are good enough to learn radii from."""
_N_RADIUS, _N_ERROR = 200, 80
_LEAST_ERROR = 1e-4


@dataclass(frozen=True, eq=False)
class _Fits:
    """n good sightings of visible droplets and what they missed."""

    features: Column
    log_ratio: Column
    """ln(true radius / fitted radius), shape (n,)."""
    offset: Column
    """True minus fitted place in fitted radii, shape (n, 2)."""
    fold: Folds


def measuring_trees(
    scenes: Sequence[Scene], seen: Sequence[Samples], folds: Folds, seed: int, report: Callable[[str], None]
) -> tuple[Trees, Trees, Trees]:
    """Trees of the radius, of its error, and of the error of the place."""
    fits = _good_fits(scenes, seen, folds)
    missed = np.empty(len(fits.fold))
    for fold in np.unique(folds):
        is_other = fits.fold != fold
        trees = regressor_trees(fits.features[is_other], fits.log_ratio[is_other], n_trees=_N_RADIUS, seed=seed)
        missed[~is_other] = fits.log_ratio[~is_other] - trees.predict(fits.features[~is_other])
    report(
        f"radius: bias {100 * np.median(missed):+.2f} %, sd {100 * missed.std():.2f} %, "
        f"robust sd {148 * np.median(np.abs(missed)):.2f} %"
    )
    radius = regressor_trees(fits.features, fits.log_ratio, n_trees=_N_RADIUS, seed=seed)
    twice, fold_twice = np.concatenate([fits.features] * 2), np.concatenate([fits.fold] * 2)
    return (
        radius,
        _error_trees(fits.features, missed, fits.fold, seed),
        _error_trees(twice, fits.offset.T.ravel(), fold_twice, seed),
    )


def _good_fits(scenes: Sequence[Scene], seen: Sequence[Samples], folds: Folds) -> _Fits:
    features, log_ratio, offset, fold_of = [], [], [], []
    for scene, samples, fold in zip(scenes, seen, folds, strict=True):
        is_good = (samples.is_droplet == 1) & (samples.cost < _GOOD_FIT)
        row, fitted = samples.true_row[is_good], samples.sightings[is_good]
        features.append(fitted.features)
        log_ratio.append(np.log(scene.r_px[row] / fitted.r_px))
        away = np.column_stack([scene.x_px[row] - fitted.x_px, scene.y_px[row] - fitted.y_px])
        offset.append(away / fitted.r_px[:, None])
        fold_of.append(np.full(len(row), fold))
    return _Fits(*(np.concatenate(parts) for parts in (features, log_ratio, offset, fold_of)))


def _error_trees(features: Column, missed: Column, fold_of: Folds, seed: int) -> Trees:
    """Trees of ln of the error that 68 % do not exceed, shifted so that this is so on scenes they have not seen."""
    log_error = np.log(np.abs(missed) + _LEAST_ERROR)
    above = np.empty(len(log_error))
    for fold in np.unique(fold_of):
        is_other = fold_of != fold
        trees = regressor_trees(
            features[is_other], log_error[is_other], n_trees=_N_ERROR, seed=seed, quantile=_ONE_SIGMA
        )
        above[~is_other] = log_error[~is_other] - trees.predict(features[~is_other])
    trees = regressor_trees(features, log_error, n_trees=_N_ERROR, seed=seed, quantile=_ONE_SIGMA)
    return scaled(trees, 1.0, float(np.quantile(above, _ONE_SIGMA)))
