"""The whole course of training: scenes, first look, second look, radius and errors, each judged on held-out scenes."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.looks import FirstLook, first_look, second_look
from dropflow.detection.default.model import Model
from dropflow.detection.default.training.acceptance import acceptance_trees, calibration, classifier_of
from dropflow.detection.default.training.backlit import backlit_scene
from dropflow.detection.default.training.films import film_scene
from dropflow.detection.default.training.measures import measuring_trees
from dropflow.detection.default.training.samples import Samples, labelled, prepared
from dropflow.detection.default.training.scenes import Scene
from dropflow.detection.default.training.shapes import disc_scene, empty_scene
from dropflow.detection.default.trees import Trees
from dropflow.provenance import code_version

Image = npt.NDArray[np.float32]

N_FOLDS = 4
_N_FIRST = 120
_RANGE_PERCENT = (0.5, 99.5)


@dataclass(frozen=True)
class Syllabus:
    """How many scenes of each kind."""

    films: int = 80
    backlit: int = 60
    discs: int = 12
    empty: int = 10

    def scenes(self) -> list[Callable[[], Scene]]:
        """Makers of all scenes, each made when it is needed."""
        kinds: list[tuple[Callable[[int], Scene], int]] = [
            (film_scene, self.films),
            (backlit_scene, self.backlit),
            (disc_scene, self.discs),
            (empty_scene, self.empty),
        ]
        return [partial(kind, seed) for kind, n in kinds for seed in range(n)]


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
    folds = np.array([desk.fold for desk in desks])
    # What the second look sees depends on what the first took for sure: in training as later, with trees that have not
    # seen the scene.
    held_out = [_first_trees([d for d in desks if d.fold != fold], seed) for fold in range(N_FOLDS)]
    first_odds = [held_out[desk.fold].predict(desk.samples.sightings.features) for desk in desks]
    report(calibration("first look", first_odds, [desk.samples for desk in desks]))
    seen = [_seen_again(desk, held_out[desk.fold]) for desk in desks]
    again, odds = acceptance_trees(seen, folds, seed)
    report(calibration("second look", odds, seen))
    measuring = measuring_trees([desk.scene for desk in desks], seen, folds, seed, report)
    low, high = _ranges(seen)
    about: dict[str, Any] = {
        "dropflow": code_version(),
        "syllabus": vars(syllabus),
        "seed": seed,
        "n_droplets": int(sum(np.sum(samples.is_droplet == 1) for samples in seen)),
    }
    return Model(_first_trees(desks, seed), again, *measuring, low=low, high=high, about=about)


def _desk(scene: Scene, number: int, report: Callable[[str], None]) -> Desk:
    image = prepared(scene)
    first = first_look(image, None, r_min_px=scene.r_min_px, r_max_px=scene.r_max_px)
    samples = labelled(scene, first.sightings)
    n_found, n_there = len(set(samples.true_row[samples.is_droplet == 1].tolist())), int(scene.is_visible.sum())
    report(f"{number:4d} {scene.family:8s} {n_found} of {n_there} in {len(first.sightings)} sightings")
    return Desk(scene, image, first, samples, number % N_FOLDS)


def _first_trees(desks: Sequence[Desk], seed: int) -> Trees:
    return classifier_of([desk.samples for desk in desks], n_trees=_N_FIRST, seed=seed)


def _seen_again(desk: Desk, first_trees: Trees) -> Samples:
    """The second look of a scene after a first look with these trees."""
    nothing = Trees(**{name: np.empty(0, array.dtype) for name, array in vars(first_trees).items()})
    model = Model(first_trees, *(nothing,) * 4, low=np.empty(0), high=np.empty(0), about={})
    scene = desk.scene
    seen = second_look(desk.image, desk.first, model, r_min_px=scene.r_min_px, r_max_px=scene.r_max_px)
    return labelled(scene, seen)


def _ranges(seen: Sequence[Samples]) -> npt.NDArray[np.float64]:
    """Lower and upper end of each feature of droplets, shape (2, n features)."""
    features = np.concatenate([samples.sightings.features[samples.is_droplet == 1] for samples in seen])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanpercentile(features, _RANGE_PERCENT, axis=0))
