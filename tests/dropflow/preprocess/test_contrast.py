"""Percentiles from a histogram, the stretch between two levels, and the noise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dropflow.preprocess import Blur, noise_std, percentiles, smooth, stretch

LEVELS = st.floats(-1e4, 1e4, width=32)
IMAGES = hnp.arrays(np.float32, hnp.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=12), elements=LEVELS)


def test_percentiles_are_those_of_sorting():
    image = np.random.default_rng(3).gamma(2, 30, (300, 200)).astype(np.float32)
    found = percentiles(image, [1, 50, 99.7])
    assert np.allclose(found, np.percentile(image, [1, 50, 99.7]), atol=2 * np.ptp(image) / 65536 + 0.05)


@given(IMAGES, st.floats(0, 100))
def test_percentiles_lie_within_the_levels(image, percent):
    (found,) = percentiles(image, [percent])
    assert image.min() - 1e-3 <= found <= np.nextafter(image.max(), np.float32(np.inf)) + 1e-3


@given(IMAGES, LEVELS, st.floats(1e-3, 1e4))
def test_stretch_gives_levels_0_to_255(image, black, span):
    stretched = stretch(image, black=black, white=black + span)
    assert stretched.dtype == np.float32
    assert stretched.min() >= 0
    assert stretched.max() <= 255


def test_stretch_maps_two_levels_to_the_ends():
    image = np.linspace(-5, 5, 10_000, dtype=np.float32).reshape(100, 100)
    stretched = stretch(image.copy(), black=-4, white=4)
    middle = (image > -3.9) & (image < 3.9)
    assert np.allclose(stretched[middle], (image[middle] + 4) / 8 * 255, atol=0.5)
    assert (stretched[image < -4.1] == 0).all()
    assert (stretched[image > 4.1] == 255).all()


def test_contrast_that_is_rounding_beside_the_levels_gives_zeros():
    rounding = np.random.default_rng(0).normal(0, 1e-3, (50, 50)).astype(np.float32)
    assert not stretch(rounding, black=-2e-3, white=3e-3, reference=1e5).any()


@pytest.mark.parametrize("blur_px", [0.0, 1.0, 3.9])
def test_the_noise_before_a_blur_is_measured_after_it(blur_px):
    """In the levels after it, with a slope and with droplets on a third of the frame."""
    noise = np.random.default_rng(1).normal(0, 40, (700, 800)).astype(np.float32)
    blurred = smooth(noise, Blur(blur_px, blur_px)) if blur_px else noise
    truth = blurred.std()
    rows, columns = np.indices(noise.shape, np.float32)
    on_droplets = np.where(np.hypot(rows % 150 - 75, columns % 150 - 75) < 50, np.float32(30 * truth), 0)
    measured = noise_std(blurred + on_droplets + 0.05 * truth * columns, apart_px=6.4, blur_px=blur_px)
    assert measured == pytest.approx(truth, rel=0.3)


def test_a_frame_too_narrow_to_tell_has_no_noise():
    assert noise_std(np.ones((50, 9), np.float32), apart_px=5, blur_px=1) == 0
