from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dropflow.droplets import Droplets
from dropflow.tracking.probable.association import (
    Association,
    Chances,
    associate,
    log_radius_density,
)
from dropflow.tracking.probable.candidates import pair_probabilities
from dropflow.tracking.probable.expectation import Predicted
from tests.dropflow.tracking.generated import droplets_at

UP = (0.0, -1.0)


def predicted(droplets: Droplets, across_px: float = 2.0, along_px: float = 2.0, log_r_std: float = 0.05) -> Predicted:
    n = len(droplets)
    return Predicted(droplets, np.full(n, across_px**2), np.full(n, along_px**2), np.full(n, log_r_std), UP)


def weigh(expected: Predicted, found: Droplets, surprise_per_px2: float = 1e-4) -> Association:
    return associate(expected, found, Chances(0.9, surprise_per_px2))


def exact(weights: np.ndarray) -> np.ndarray:
    """Probabilities of pairs by going through all ways to pair."""
    n_first, n_second = weights.shape
    total, pairs = 0.0, np.zeros_like(weights)
    for choice in product(range(-1, n_second), repeat=n_first):
        taken = [second for second in choice if second >= 0]
        if len(set(taken)) < len(taken):
            continue
        chance = float(np.prod([weights[first, second] for first, second in enumerate(choice) if second >= 0]))
        total += chance
        for first, second in enumerate(choice):
            if second >= 0:
                pairs[first, second] += chance
    return pairs / total


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 3), st.integers(1, 3), st.integers(0, 2**31))
def test_probabilities_are_close_to_those_of_all_ways_to_pair(n_first: int, n_second: int, seed: int) -> None:
    """Belief propagation errs by less than a tenth on small crowds in which everybody may be everybody."""
    log_weight = np.random.default_rng(seed).normal(0, 2, (n_first, n_second))
    first, second = (index.ravel() for index in np.indices((n_first, n_second)))
    found = pair_probabilities(first, second, log_weight.ravel(), n_first, n_second)
    np.testing.assert_allclose(found.reshape(n_first, n_second), exact(np.exp(log_weight)), atol=0.12)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**31), st.integers(1, 60), st.integers(1, 60))
def test_no_droplet_is_two(seed: int, n_predicted: int, n_found: int) -> None:
    """The probabilities of a droplet's pairs sum to one at most, and it is taken once at most."""
    rng = np.random.default_rng(seed)
    places = [np.column_stack([rng.uniform(0, 40, (n, 2)), rng.uniform(4, 6, n)]) for n in (n_predicted, n_found)]
    result = weigh(predicted(droplets_at(places[0]), 5.0, 5.0), droplets_at(places[1]))
    assert np.bincount(result.first, result.probability, n_predicted).max(initial=0) <= 1 + 1e-6
    pairs = result.pairs()
    assert len(set(pairs.second.tolist())) == len(set(pairs.first.tolist())) == len(pairs)


def test_how_far_is_too_far_follows_from_the_errors() -> None:
    """Eight pixels off is nothing for a vague prediction and out of the question for a sure one."""
    found = droplets_at([(108.0, 100.0, 5.0)])
    vague, sure = (predicted(droplets_at([(100.0, 100.0, 5.0)]), std, std) for std in (6.0, 1.0))
    assert len(weigh(vague, found).pairs()) == 1
    assert len(weigh(sure, found).pairs()) == 0


def test_errors_along_gravity_do_not_excuse_those_across() -> None:
    """A big droplet's sedimentation is uncertain; that speaks of up and down alone."""
    expected = predicted(droplets_at([(100.0, 100.0, 20.0)]), across_px=1.0, along_px=15.0)
    below, beside = droplets_at([(100.0, 120.0, 20.0)]), droplets_at([(120.0, 100.0, 20.0)])
    assert len(weigh(expected, below).pairs()) == 1
    assert len(weigh(expected, beside).pairs()) == 0


def test_the_right_size_decides_between_two_in_reach() -> None:
    """The nearer one has another radius."""
    found = droplets_at([(101.0, 100.0, 7.0), (104.0, 100.0, 5.0)])
    pairs = weigh(predicted(droplets_at([(100.0, 100.0, 5.0)]), 3.0, 3.0), found).pairs()
    assert pairs.second.tolist() == [1]


def test_what_cannot_be_told_apart_is_not_paired() -> None:
    """Two equal droplets at equal distances: neither is more probable than not."""
    found = droplets_at([(98.0, 100.0, 5.0), (102.0, 100.0, 5.0)])
    result = weigh(predicted(droplets_at([(100.0, 100.0, 5.0)])), found)
    assert result.probability == pytest.approx([0.5, 0.5], abs=0.05)
    assert len(result.pairs()) == 0


def test_in_a_crowd_of_surprises_a_pair_must_be_closer() -> None:
    """The same pair is believed among few unknown detections and not among many."""
    expected, found = predicted(droplets_at([(100.0, 100.0, 5.0)]), 8.0, 8.0), droplets_at([(112.0, 100.0, 5.0)])
    few, many = (weigh(expected, found, density).probability[0] for density in (1e-5, 3e-2))
    assert few > 0.9
    assert many < 0.5


def test_without_droplets_there_are_no_pairs() -> None:
    """On either side."""
    some, none = droplets_at([(1.0, 1.0, 5.0)]), Droplets.empty()
    assert len(weigh(predicted(none), some).pairs()) == 0
    assert len(weigh(predicted(some), none).pairs()) == 0


def test_the_density_of_radii_integrates_to_one() -> None:
    """Over ln r."""
    r_px = np.exp(np.random.default_rng(0).normal(2, 0.5, 4000))
    grid = np.linspace(0.0, 4.0, 400)
    density = np.exp(log_radius_density(np.append(np.log(r_px), grid))[len(r_px) :])
    assert density.sum() * (grid[1] - grid[0]) == pytest.approx(1.0, abs=0.15)
