"""Stripes are found where they are, and taken away from under droplets."""

import numpy as np
import pytest

from dropflow.preprocess import Stripes, measure_stripes, remove_stripes
from dropflow.preprocess.stripes import NO_STRIPES, Direction
from tests.dropflow.detection.discs import draw

SHAPE = (400, 600)
DISCS = ((100, 120, 20), (300, 200, 30), (500, 300, 12), (450, 90, 25))


def striped(strength, *, axis=0, discs=DISCS):
    """A frame with lines along the rows (axis 0) or columns, and the lines."""
    rng = np.random.default_rng(3)
    image = draw(discs, shape=SHAPE).astype(np.float32)
    lines = rng.normal(0, strength, SHAPE[axis]).astype(np.float32)
    lines = np.convolve(lines, np.ones(5) / np.sqrt(5), mode="same").astype(np.float32)
    return image + (lines[:, None] if axis == 0 else lines), lines


@pytest.mark.parametrize(("axis", "along"), [(0, Direction.ROWS), (1, Direction.COLUMNS)])
def test_their_direction_and_share_are_measured(axis, along):
    found = measure_stripes([striped(4, axis=axis)[0]])
    assert found.direction is along
    assert found.share > 0.7


def test_a_frame_without_has_none():
    assert measure_stripes([striped(0)[0]]) == NO_STRIPES
    assert measure_stripes([]) == NO_STRIPES


@pytest.mark.parametrize("axis", [0, 1])
def test_most_of_them_is_taken_away_and_droplets_stay(axis):
    image, _ = striped(4, axis=axis)
    without, _ = striped(0, axis=axis)
    before = np.abs(image - without).mean()
    remove_stripes(image, measure_stripes([image]))
    left = image - without
    assert np.abs(left - np.median(left)).mean() < 0.45 * before


def test_none_leave_the_image_as_it_is():
    image, _ = striped(4)
    before = image.copy()
    remove_stripes(image, NO_STRIPES)
    assert (image == before).all()


@pytest.mark.parametrize("shape", [(1, 1), (30, 1000), (400, 50)])
def test_frames_too_small_to_tell_are_left_alone(shape):
    image = np.random.default_rng(0).normal(size=shape).astype(np.float32)
    assert measure_stripes([image]) == NO_STRIPES
    before = image.copy()
    remove_stripes(image, Stripes(Direction.ROWS, 1.0))
    assert (image == before).all()
