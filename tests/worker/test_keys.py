"""Addresses of products: alike for alike input, different for everything that could make a difference."""

from typing import Any

import pytest

from dropflow.experiment import Experiment, parse_experiment
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters, parse_parameters
from tests.films import EXPERIMENT, PARAMETERS
from worker.keys import detection_key, film_key, range_key, source_digest

INDEX = StackIndex(
    n_frames=6,
    n_rows=10,
    n_columns=10,
    dtype="uint8",
    times_s=(0.0, 1.0, 2.0, 3.0, 4.0, 5.0),
    files=(),
    sha256="a" * 64,
)


def _experiment(**changes: Any) -> Experiment:
    return parse_experiment(EXPERIMENT | changes)


def _parameters(**changes: Any) -> Parameters:
    return parse_parameters(PARAMETERS | changes)


BASE = detection_key(INDEX, _experiment(), _parameters())


@pytest.mark.parametrize(
    "changes", [{"name": "other"}, {"notes": "new"}, {"tags": ["a"]}, {"recorded_at": "2026-01-01T00:00:00Z"}]
)
def test_what_is_only_for_people_makes_no_difference_to_detection(changes: dict[str, Any]) -> None:
    assert detection_key(INDEX, _experiment(**changes), _parameters()) == BASE
    assert film_key("track", [BASE], _experiment(**changes), _parameters()) != film_key(
        "track", [BASE], _experiment(), _parameters()
    )


def test_what_is_only_for_tracking_makes_no_difference_to_detection() -> None:
    other = _parameters(flow={"n_columns": 6, "n_rows": 6})
    assert detection_key(INDEX, _experiment(), other) == BASE
    assert film_key("track", [BASE], _experiment(), other) != film_key("track", [BASE], _experiment(), _parameters())


@pytest.mark.parametrize("changes", [{"pixel_size_um": 1.1}, {"droplets": "dark"}, {"up": [1, 0]}])
def test_what_was_filmed_makes_a_difference(changes: dict[str, Any]) -> None:
    assert detection_key(INDEX, _experiment(**changes), _parameters()) != BASE


@pytest.mark.parametrize(
    "index",
    [
        INDEX.model_copy(update={"sha256": "b" * 64}),
        INDEX.model_copy(update={"times_s": (0.0, 1.5, 2.0, 3.0, 4.0, 5.0)}),
    ],
)
def test_other_frames_or_times_make_a_difference(index: StackIndex) -> None:
    assert detection_key(index, _experiment(), _parameters()) != BASE


def test_each_range_and_task_has_its_own() -> None:
    keys = {range_key(BASE, frames) for frames in (range(2), range(2, 4), range(3))}
    keys |= {film_key(task, [BASE], _experiment(), _parameters()) for task in ("track", "analyse")}
    assert len(keys) == 5


def test_the_code_counts_as_it_stands() -> None:
    assert len(source_digest()) == 64
    assert source_digest() == source_digest()
