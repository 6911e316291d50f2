"""Percentiles from a histogram, and the stretch between them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dropflow.preprocess import percentiles, stretch

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


@given(IMAGES)
def test_stretch_gives_levels_0_to_255(image):
    stretched = stretch(image, low_percent=1, high_percent=99.7)
    assert stretched.dtype == np.float32
    assert stretched.min() >= 0
    assert stretched.max() <= 255


def test_stretch_maps_the_two_percentiles_to_the_ends():
    image = np.linspace(-5, 5, 10_000, dtype=np.float32).reshape(100, 100)
    stretched = stretch(image.copy(), low_percent=10, high_percent=90)
    middle = (image > -3.9) & (image < 3.9)
    assert np.allclose(stretched[middle], (image[middle] + 4) / 8 * 255, atol=0.5)
    assert (stretched[image < -4.1] == 0).all()
    assert (stretched[image > 4.1] == 255).all()


def test_contrast_that_is_rounding_beside_the_levels_gives_zeros():
    rounding = np.random.default_rng(0).normal(0, 1e-3, (50, 50)).astype(np.float32)
    assert not stretch(rounding, low_percent=1, high_percent=99.7, reference=1e5).any()
