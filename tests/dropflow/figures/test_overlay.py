"""Droplets drawn on their frame."""

import numpy as np
import pytest

from dropflow.droplets import Droplets
from dropflow.figures.overlay import draw_overlay


def droplets(*circles):
    x, y, r, match = (np.array(column, float) for column in zip(*circles, strict=True))
    return Droplets(x, y, r, r * 0, r * 0, r * 0 + 1, match)


@pytest.mark.parametrize("scale", [1, 3])
def test_circles_are_where_the_droplets_are(scale):
    frame = np.full((200, 300), 100, np.uint16)
    plain = draw_overlay(frame, Droplets.empty(), scale=scale)
    picture = draw_overlay(frame, droplets((150, 80, 30, 1.0)), scale=scale)
    assert picture.shape == (200 * scale, 300 * scale, 3)
    assert picture.dtype == np.uint8
    rows, columns = np.nonzero((picture != plain).any(axis=2))
    distance = np.hypot(columns - (150 * scale + (scale - 1) / 2), rows - (80 * scale + (scale - 1) / 2))
    assert np.abs(distance - 30 * scale).max() < 2
    assert distance.size > 100


def test_a_better_match_is_yellow_and_a_worse_one_blue():
    picture = draw_overlay(np.zeros((200, 300), np.uint8), droplets((70, 80, 30, 0.1), (200, 80, 30, 2.0)))
    worse, better = picture[80, 40].astype(int), picture[80, 170].astype(int)
    assert better[0] > 150 > worse[0]
    assert worse[2] > better[2]


def test_the_contrast_of_any_depth_is_stretched():
    frame = np.linspace(1000, 1100, 60_000, dtype=np.uint16).reshape(200, 300)
    picture = draw_overlay(frame, Droplets.empty())
    assert picture[0, 0, 0] < 5
    assert picture[150, 299].max() > 180


@pytest.mark.parametrize(("width", "pixel_size_um", "length_px"), [(300, None, 50), (300, 0.5, 40), (1000, 2.0, 100)])
def test_the_scale_bar_has_a_round_length_of_at_most_a_fifth(width, pixel_size_um, length_px):
    """50 px, 20 um and 200 um."""
    picture = draw_overlay(np.zeros((200, width), np.uint8), Droplets.empty(), pixel_size_um=pixel_size_um)
    white_columns = np.flatnonzero((picture[-20:] == 255).all(axis=2).any(axis=0))
    assert np.ptp(white_columns) == pytest.approx(length_px, abs=1)


def test_a_frame_of_one_pixel_can_be_drawn():
    assert draw_overlay(np.zeros((1, 1), np.uint8), Droplets.empty()).shape == (1, 1, 3)
