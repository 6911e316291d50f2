"""Uneven light and dirt, told from a film in which droplets move."""

import numpy as np
import pytest

from dropflow.experiment import DropletTone
from dropflow.preprocess import estimate_stack
from dropflow.preprocess.background import dirt_map, estimated_flat_field, median_frame
from tests.dropflow.detection.discs import draw, experiment, parameters

SHAPE = (300, 360)
SPOTS = ((80, 100), (250, 60), (190, 220))


def film(n_frames, tone, *, step=25.0, dirt=0.4):
    """Moving droplets behind spots of dirt, under a lamp that is brighter on the left; and the light that passes."""
    rng = np.random.default_rng(2)
    rows, columns = np.indices(SHAPE)
    light = 1.15 - 0.3 * columns / SHAPE[1]
    chip = np.ones(SHAPE)
    for x, y in SPOTS:
        chip[np.hypot(columns - x, rows - y) < 4] = 1 - dirt
    x, y, r = rng.uniform(0, 2000, 60) - 800, rng.uniform(0, SHAPE[0], 60), rng.uniform(6, 25, 60)
    frames = []
    for index in range(n_frames):
        here = x + step * index
        is_near = (here > -r) & (here < SHAPE[1] + r)
        discs = np.column_stack([here, y, r])[is_near].tolist()
        drawn = draw(discs, shape=SHAPE, level=40, contrast=120, noise=0).astype(float)
        levels = (200 - 0.6 * drawn if tone is DropletTone.DARK else drawn) * light * chip
        frames.append(np.clip(levels + rng.normal(0, 1.0, SHAPE), 0, 255).astype(np.uint8))
    return frames, light, chip


def test_the_lamp_is_told_behind_dark_droplets():
    frames, light, _ = film(14, DropletTone.DARK)
    flat = estimated_flat_field(frames, DropletTone.DARK, r_max_px=25)
    assert flat.mean() == pytest.approx(1, abs=1e-5)
    inner = np.s_[60:-60, 60:-60]
    assert np.abs(flat / (light / light.mean()) - 1)[inner].mean() < 0.04
    assert not dirt_map(flat).any()  # small things that stand still may be droplets


def test_dirt_is_told_before_bright_droplets():
    frames, _, chip = film(14, DropletTone.BRIGHT)
    flat = estimated_flat_field(frames, DropletTone.BRIGHT, r_max_px=25)
    found = dirt_map(flat)
    assert all(found[y - 2 : y + 3, x - 2 : x + 3].mean() > 0.9 for x, y in SPOTS)
    assert found[chip == 1].mean() < 0.01


def test_droplets_that_do_not_move_are_not_divided_away():
    """Neither dark ones, nor what is between bright ones."""
    frames, light, _ = film(14, DropletTone.DARK, step=0.0, dirt=0.0)
    flat = estimated_flat_field(frames, DropletTone.DARK, r_max_px=25)
    assert np.abs(flat / (light / light.mean()) - 1).max() < 0.15
    frames, _, _ = film(14, DropletTone.BRIGHT, step=0.0, dirt=0.0)
    flat = estimated_flat_field(frames, DropletTone.BRIGHT, r_max_px=25)
    assert flat is None or dirt_map(flat).mean() < 1e-3


@pytest.mark.parametrize("n_frames", [1, 8])
def test_few_frames_tell_nothing(n_frames):
    assert estimated_flat_field(film(n_frames, DropletTone.DARK)[0], DropletTone.DARK, r_max_px=25) is None


def test_a_black_background_divides_nothing():
    noise = np.random.default_rng(0)
    frames = [np.abs(noise.normal(0, 2, SHAPE)).astype(np.uint8) for _ in range(10)]
    assert estimated_flat_field(frames, DropletTone.BRIGHT, r_max_px=25) is None


def test_the_median_is_that_of_the_frames():
    frames = [np.full((200, 5), value, np.uint16) for value in (5, 900, 7, 6, 60_000)]
    assert (median_frame(frames) == 7).all()


def test_a_given_flat_field_comes_first_and_the_papers_method_estimates_none():
    frames, _, _ = film(12, DropletTone.BRIGHT)
    given = estimate_stack(frames, experiment(), parameters(), np.ones(SHAPE))
    assert not given.is_flat_field_estimated
    assert (given.flat_field == 1).all()
    assert estimate_stack(frames, experiment(), parameters(method="paper")).flat_field is None
    estimated = estimate_stack(frames, experiment(), parameters())
    assert estimated.is_flat_field_estimated
    assert dirt_map(estimated.flat_field).any()
