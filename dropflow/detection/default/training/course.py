"""The whole course of training: scenes, first look, second look, radius and errors, calibration on held-out scenes."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.looks import FirstLook, first_look, second_look
from dropflow.detection.default.model import Model, probability_of
from dropflow.detection.default.training.backlit import backlit_scene
from dropflow.detection.default.training.films import film_scene
from dropflow.detection.default.training.growing import classifier_trees, regressor_trees, scaled
from dropflow.detection.default.training.samples import Samples, labelled, prepared
from dropflow.detection.default.training.scenes import Scene
from dropflow.detection.default.training.shapes import disc_scene, empty_scene
from dropflow.detection.default.trees import Trees
from dropflow.provenance import code_version

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

N_FOLDS = 4
_ONE_SIGMA = 0.683
_GOOD_FIT = 0.5
"""Sightings with less cost than this are good enough to learn radii from."""
_N_FIRST, _N_AGAIN, _N_ERROR = 120, 200, 80


@dataclass(frozen=True)
class Syllabus:
    """How many scenes of each kind."""

    films: int = 80
    backlit: int = 40
    discs: int = 20
    empty: int = 10

    def scenes(self) -> list[Callable[[], Scene]]:
        """Makers of all scenes, each made when it is needed."""
        kinds = (film_scene, self.films), (backlit_scene, self.backlit), (disc_scene, self.discs), (empty_scene, self.empty)
        return [lambda kind=kind, seed=seed: kind(seed) for kind, n in kinds for seed in range(n)]  # type: ignore[misc]


@dataclass(frozen=True, eq=False)
class Desk:
    """One scene being worked on."""

    scene: Scene
    image: Image
    first: FirstLook
    samples: Samples
    fold: int


def train(syllabus: Syllabus, report: Callable[[str], None], *, seed: int = 0) -> Model:
    """Grow a model on the scenes of `syllabus`; `report` is told what happens."""
    desks = [_desk(make(), number, report) for number, make in enumerate(syllabus.scenes())]
    # What the second look sees depends on what the first took for sure: in training as later, with trees that have not
    # seen the scene.
    held_out = [_first_trees([d for d in desks if d.fold != fold], seed) for fold in range(N_FOLDS)]
    report(_calibration("first look", [(held_out[d.fold].predict(d.samples.sightings.features), d.samples) for d in desks]))
    again = [_second(desk, held_out[desk.fold]) for desk in desks]
    folds = np.array([desk.fold for desk in desks])
    second, log_odds = _second_trees(again, folds, seed)
    report(_calibration("second look", list(zip(log_odds, again, strict=True))))
    radius, radius_error, position_error = _measure_trees(desks, again, folds, seed, report)
    seen = np.concatenate([s.sightings.features[s.is_droplet == 1] for s in again])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        low, high = np.nanpercentile(seen, [0.5, 99.5], axis=0)
    about: dict[str, Any] = {
        "version": f"{datetime.now(UTC):%Y-%m-%d}",
        "dropflow": code_version(),
        "syllabus": vars(syllabus),
        "n_droplets": int(sum(np.sum(s.is_droplet == 1) for s in again)),
    }
    first = _calibrated(_first_trees(desks, seed), 1.0, 0.0)
    return Model(first, second, radius, radius_error, position_error, low, high, about)


def _desk(scene: Scene, number: int, report: Callable[[str], None]) -> Desk:
    image = prepared(scene)
    first = first_look(image, None, r_min_px=scene.r_min_px, r_max_px=scene.r_max_px)
    samples = labelled(scene, first.sightings)
    found = len(set(samples.true_row[samples.is_droplet == 1].tolist()))
    report(f"{number:4d} {scene.family:8s} {found} of {int(scene.is_visible.sum())} in {len(first.sightings)} sightings")
    return Desk(scene, image, first, samples, number % N_FOLDS)


def _stack(samples: Sequence[Samples]) -> tuple[Column, Column, Column]:
    """Features, labels and weights of all that counts; each family of scenes has its say."""
    features = np.concatenate([s.sightings.features for s in samples])
    labels = np.concatenate([s.is_droplet for s in samples])
    weight = np.concatenate([np.full(len(s.is_droplet), _WEIGHTS.get(s.family, 1.0)) for s in samples])
    counts = np.isfinite(labels)
    return features[counts], labels[counts], weight[counts]


_WEIGHTS = {"empty": 2.0}


def _first_trees(desks: Sequence[Desk], seed: int) -> Trees:
    return classifier_trees(*_stack([desk.samples for desk in desks]), n_trees=_N_FIRST, seed=seed)


def _second(desk: Desk, first_trees: Trees) -> Samples:
    nothing = Trees(*(np.empty(0, t.dtype) for t in vars(first_trees).values()))
    model = Model(first_trees, *(nothing,) * 4, np.empty(0), np.empty(0), {})
    scene = desk.scene
    seen = second_look(desk.image, desk.first, model, r_min_px=scene.r_min_px, r_max_px=scene.r_max_px)
    return labelled(scene, seen)


def _second_trees(again: Sequence[Samples], folds: npt.NDArray[np.int64], seed: int) -> tuple[Trees, list[Column]]:
    """Calibrated trees, and the calibrated log odds of each scene by trees that have not seen it."""
    log_odds: list[Column] = [np.empty(0)] * len(again)
    for fold in range(N_FOLDS):
        others = [s for s, f in zip(again, folds, strict=True) if f != fold]
        trees = classifier_trees(*_stack(others), n_trees=_N_AGAIN, seed=seed)
        for i in np.flatnonzero(folds == fold):
            log_odds[i] = trees.predict(again[i].sightings.features)
    # Of doubles only the likeliest is ever reported.
    is_kept = np.concatenate([s.sightings.best(column) for s, column in zip(again, log_odds, strict=True)])
    is_droplet = np.concatenate([s.is_droplet for s in again])
    factor, shift = _platt(np.concatenate(log_odds)[is_kept], is_droplet[is_kept])
    trees = _calibrated(classifier_trees(*_stack(again), n_trees=_N_AGAIN, seed=seed), factor, shift)
    return trees, [factor * column + shift for column in log_odds]


def _platt(log_odds: Column, is_droplet: Column) -> tuple[float, float]:
    """Factor and shift that make log odds those of the labels (logistic regression)."""
    from sklearn.linear_model import LogisticRegression

    counts = np.isfinite(is_droplet)
    fit = LogisticRegression(C=1e6).fit(log_odds[counts, None], is_droplet[counts])
    return float(fit.coef_[0, 0]), float(fit.intercept_[0])


def _calibrated(trees: Trees, factor: float, shift: float) -> Trees:
    return scaled(trees, factor, shift)


def _measure_trees(
    desks: Sequence[Desk], again: Sequence[Samples], folds: npt.NDArray[np.int64], seed: int,
    report: Callable[[str], None],
) -> tuple[Trees, Trees, Trees]:  # fmt: skip
    """Trees of the radius and of both errors, from sightings of visible droplets."""
    features, ratio, offsets, group = [], [], [], []
    for desk, samples, fold in zip(desks, again, folds, strict=True):
        good = (samples.is_droplet == 1) & (samples.cost < _GOOD_FIT)
        row, seen = samples.true_row[good], samples.sightings[good]
        features.append(seen.features)
        ratio.append(np.log(desk.scene.r_px[row] / seen.r_px))
        offsets.append(
            np.stack([desk.scene.x_px[row] - seen.x_px, desk.scene.y_px[row] - seen.y_px], 1) / seen.r_px[:, None]
        )
        group.append(np.full(len(row), fold))
    x, target, off, fold_of = (np.concatenate(parts) for parts in (features, ratio, offsets, group))
    left_over = np.empty(len(target))
    for fold in range(N_FOLDS):
        is_other = fold_of != fold
        trees = regressor_trees(x[is_other], target[is_other], n_trees=_N_AGAIN, seed=seed)
        left_over[~is_other] = target[~is_other] - trees.predict(x[~is_other])
    radius = regressor_trees(x, target, n_trees=_N_AGAIN, seed=seed)
    report(
        f"radius: bias {100 * np.median(left_over):+.2f} %, sd {100 * left_over.std():.2f} %, "
        f"robust sd {148 * np.median(np.abs(left_over)):.2f} %"
    )
    radius_error = _error_trees(x, np.log(np.abs(left_over) + 1e-4), fold_of, seed)
    twice = np.concatenate([x, x])
    position_error = _error_trees(
        twice, np.log(np.abs(off.T.ravel()) + 1e-4), np.concatenate([fold_of, fold_of]), seed
    )
    return radius, radius_error, position_error


def _error_trees(features: Column, log_error: Column, fold_of: npt.NDArray[np.int64], seed: int) -> Trees:
    """Trees of the error that 68 % do not exceed, shifted so that this is so on scenes they have not seen."""
    above = np.empty(len(log_error))
    for fold in range(N_FOLDS):
        is_other = fold_of != fold
        trees = regressor_trees(
            features[is_other], log_error[is_other], n_trees=_N_ERROR, seed=seed, quantile=_ONE_SIGMA
        )
        above[~is_other] = log_error[~is_other] - trees.predict(features[~is_other])
    trees = regressor_trees(features, log_error, n_trees=_N_ERROR, seed=seed, quantile=_ONE_SIGMA)
    return scaled(trees, 1.0, float(np.quantile(above, _ONE_SIGMA)))


def _calibration(name: str, looked: Sequence[tuple[Column, Samples]]) -> str:
    """Of what was given about so much probability by trees that had not seen it, how much is a droplet."""
    is_kept = [samples.sightings.best(log_odds) for log_odds, samples in looked]
    probability = np.concatenate([probability_of(looked[i][0])[kept] for i, kept in enumerate(is_kept)])
    is_droplet = np.concatenate([looked[i][1].is_droplet[kept] for i, kept in enumerate(is_kept)])
    counts = np.isfinite(is_droplet)
    lines = [f"{name}: {int(np.sum(is_droplet == 1))} of {int(counts.sum())} are droplets"]
    for low in np.arange(0, 1, 0.1):
        of_bin = counts & (probability >= low) & (probability < low + 0.1)
        if of_bin.any():
            lines.append(f"  {low + 0.05:.2f}: {is_droplet[of_bin].mean():.3f} of {int(of_bin.sum())}")
    return "\n".join(lines)

