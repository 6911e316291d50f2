"""The noise of a frame, measured on the frame."""

import numpy as np
import pytest

from dropflow.preprocess import noise_level
from tests.dropflow.detection.discs import ISOLATED, draw


@pytest.mark.parametrize("sigma", [0.8, 3.0, 12.0])
@pytest.mark.parametrize("discs", [(), ISOLATED], ids=["empty", "with droplets"])
def test_white_noise_is_measured_within_a_tenth(sigma, discs):
    assert noise_level(draw(discs, level=80, noise=sigma).astype(np.float32)) == pytest.approx(sigma, rel=0.1)


def test_a_slope_is_no_noise():
    ground = np.linspace(0, 500, 400, dtype=np.float32)[None, :] + np.zeros((300, 1), np.float32)
    noise = np.random.default_rng(0).normal(0, 3, ground.shape).astype(np.float32)
    assert noise_level(ground + noise) == pytest.approx(3, rel=0.1)


@pytest.mark.parametrize("shape", [(1, 1), (2, 50), (3, 3), (40, 40)])
def test_it_is_positive_for_any_frame(shape):
    assert noise_level(np.full(shape, 9, np.float32)) > 0
