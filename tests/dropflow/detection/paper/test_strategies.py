"""Each strategy by itself: thresholds with a distance map, and watershed with markers."""

import numpy as np
import pytest
from skimage.morphology import h_maxima
from skimage.segmentation import watershed

from dropflow.detection.paper.extended import extended_maxima
from dropflow.detection.paper.thresholding import background_level, find_by_threshold, threshold_levels
from dropflow.detection.paper.watershed import find_by_watershed, flood
from dropflow.parameters import PaperDetection
from tests.dropflow.detection.discs import ISOLATED, draw

RANGE = {"r_min_px": 4.0, "r_max_px": 50.0}
STRATEGIES = {
    "threshold for small": lambda image: find_by_threshold(image, 55.0, **RANGE),
    "threshold for big": lambda image: find_by_threshold(image, 90.0, **RANGE),
    "watershed": lambda image: find_by_watershed(image, maxima_height=20.0, **RANGE),
}


def distance_and_ratio(circles, disc):
    x, y, r = disc
    distance = np.hypot(circles.x_px - x, circles.y_px - y)
    best = int(np.argmin(distance / r + np.abs(np.log(circles.r_px / r))))
    return distance[best] / r, circles.r_px[best] / r


@pytest.mark.parametrize("strategy", STRATEGIES.values(), ids=STRATEGIES)
@pytest.mark.parametrize("disc", ISOLATED, ids=str)
def test_each_strategy_finds_isolated_discs(strategy, disc):
    circles = strategy(draw(ISOLATED).astype(np.float32))
    distance, ratio = distance_and_ratio(circles, disc)
    assert distance < 0.2
    assert 0.75 < ratio < 1.25


def domes(*discs):
    """Droplets that are brightest in the middle, the brighter one seen where two overlap."""
    return np.max([draw([disc], noise=0) for disc in discs], axis=0).astype(np.float32)


@pytest.mark.parametrize("strategy", STRATEGIES.values(), ids=STRATEGIES)
def test_each_strategy_parts_two_that_overlap(strategy):
    pair = (100, 150, 15), (124, 158, 14)
    circles = strategy(domes(*pair))
    assert len(circles) == 2
    for disc in pair:
        distance, ratio = distance_and_ratio(circles, disc)
        assert distance < 0.2
        assert 0.75 < ratio < 1.25


def ring(inner, outer, shape=(200, 200)):
    rows, columns = np.indices(shape)
    distance = np.hypot(rows - 100, columns - 100)
    return np.where((distance >= inner) & (distance < outer), 200, 0).astype(np.float32)


def test_background_inside_a_droplet_is_deleted():
    """A bright rim is one droplet, as wide as its outside."""
    circles = find_by_threshold(ring(20, 30), 100.0, **RANGE)
    assert len(circles) == 1
    assert (circles.x_px[0], circles.y_px[0]) == pytest.approx((100, 100), abs=1)
    assert circles.r_px[0] == pytest.approx(30, abs=1)


def test_background_wider_than_any_droplet_stays():
    circles = find_by_threshold(ring(60, 75), 100.0, **RANGE)
    assert (np.hypot(circles.x_px - 100, circles.y_px - 100) > 55).all()


@pytest.mark.parametrize("strategy", STRATEGIES.values(), ids=STRATEGIES)
@pytest.mark.parametrize("level", [0, 80, 255])
def test_a_constant_frame_has_no_circles(strategy, level):
    assert len(strategy(np.full((60, 70), level, np.float32))) == 0


def test_the_background_is_the_most_frequent_level():
    rng = np.random.default_rng(2)
    image = rng.normal(90, 6, (300, 300)).astype(np.float32)
    image[:100, :100] = rng.normal(200, 20, (100, 100))
    assert background_level(np.clip(image, 0, 255)) == pytest.approx(90, abs=3)


def test_thresholds_are_parts_of_the_way_to_white_and_above_the_noise():
    knobs = PaperDetection(threshold_small=0.2, threshold_big=0.5, noise_margin=4)
    assert threshold_levels(55, 1, knobs) == pytest.approx((95, 155))
    assert threshold_levels(55, 20, knobs) == pytest.approx((135, 155))
    assert threshold_levels(55, 60, knobs) == pytest.approx((295, 295))


@pytest.mark.parametrize("height", [1, 8, 40])
@pytest.mark.parametrize("seed", range(4))
def test_extended_maxima_are_those_of_the_h_maxima_transform(seed, height):
    """Where the definition by reconstruction has a regional maximum there is a peak, and nowhere else."""
    rng = np.random.default_rng(seed)
    coarse = rng.integers(0, 256, (12, 15)).astype(np.uint8)
    levels = np.kron(coarse, np.ones((3, 3), np.uint8))
    labels, n_maxima = extended_maxima(levels, height)
    peaks = h_maxima(levels, height, footprint=np.ones((3, 3))) > 0
    assert set(np.unique(labels)) == set(range(n_maxima + 1))
    assert {int(label) for label in labels[peaks]} == set(range(1, n_maxima + 1))


def test_the_flood_is_that_of_a_known_watershed():
    """Away from the lines themselves, which belong to either side."""
    rng = np.random.default_rng(0)
    gradient = np.kron(rng.integers(0, 256, (10, 12)), np.ones((6, 6))).astype(np.uint8)
    markers = np.zeros(gradient.shape, np.int32)
    for label, place in enumerate(((5, 5), (30, 40), (50, 10), (20, 65)), start=1):
        markers[place] = label
        gradient[place] = 0
    assert np.mean(flood(gradient, markers) == watershed(gradient, markers)) > 0.98
