"""Displacements between frames without following anything."""

import numpy as np
import pytest

from dropflow.droplets import Droplets
from dropflow.suggest import displacement

SHAPE = (1000, 1200)


def moved(n, by, *, lost=0.2, seed=0):
    """N droplets and, in the next frame, most of them moved by `by(x, y)` beside as many new ones."""
    rng = np.random.default_rng(seed)
    x, y, r = rng.uniform(0, SHAPE[1], n), rng.uniform(0, SHAPE[0], n), np.exp(rng.normal(2.5, 0.5, n))
    dx, dy = by(x, y)
    is_new = rng.uniform(size=n) < lost
    x2, y2 = (
        np.where(is_new, rng.uniform(0, SHAPE[1], n), x + dx),
        np.where(is_new, rng.uniform(0, SHAPE[0], n), y + dy),
    )
    order = rng.permutation(n)
    frames = (x, y, r), (x2[order], y2[order], (r * np.exp(rng.normal(0, 0.02, n)))[order])
    return [Droplets(*columns, *[np.ones(n)] * 4) for columns in frames]


@pytest.mark.parametrize("distance", [0.0, 5.0, 30.0, 70.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_common_displacement_is_measured(distance, seed):
    before, after = moved(400, lambda x, y: (0.6 * distance + 0 * x, -0.8 * distance + 0 * y), seed=seed)
    found = displacement(before, after, SHAPE)
    assert found.typical_px == pytest.approx(distance, abs=0.5)
    assert found.spacing_px == pytest.approx(np.sqrt(1.2e6 / 400))


def test_the_fastest_part_is_told():
    before, after = moved(600, lambda x, y: (60 * (y / 1000) ** 2, 0 * x))
    found = displacement(before, after, SHAPE)
    assert found.typical_px < 30
    assert 40 < found.largest_px < 75


def test_frames_that_have_nothing_in_common_have_no_displacement():
    before, _ = moved(400, lambda x, y: (0 * x, 0 * y))
    after, _ = moved(400, lambda x, y: (0 * x, 0 * y), seed=9)
    assert displacement(before, after, SHAPE).typical_px is None


@pytest.mark.parametrize("n", [0, 1, 3])
def test_few_droplets_tell_nothing(n):
    before, after = moved(n, lambda x, y: (5 + 0 * x, 0 * y))
    assert displacement(before, after, SHAPE).typical_px is None
