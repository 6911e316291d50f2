"""What the paper's detection says of its own certainty."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dropflow.detection.paper.confidence import position_std_px, probability, radius_std_px
from dropflow.detection.paper.detector import PaperDetector
from tests.dropflow.detection.discs import detector_for, draw, find, nearest


@given(st.floats(-10, 10), st.floats(0, 5))
def test_a_better_match_is_never_less_probable(match, more):
    low, high = probability(np.array([match, match + more]))
    assert 0 <= low <= high < 1


@given(st.floats(2, 500))
def test_uncertainties_are_positive_and_small_beside_the_radius(r_px):
    r = np.array([r_px])
    assert 0 < radius_std_px(r)[0] <= 0.22 * r_px
    assert 0 < position_std_px(r)[0] <= 0.1 * r_px


def test_most_errors_are_within_one_standard_deviation():
    """Of 60 lone discs of many radii, at least the 68 % that a standard deviation promises."""
    rng = np.random.default_rng(4)
    discs = [
        (50.0 + 100 * i + rng.uniform(-9, 9), 50.0 + 100 * j, rng.uniform(7, 30)) for i in range(10) for j in range(6)
    ]
    droplets = find(draw(discs, shape=(600, 1000), noise=4), method="paper")
    errors = np.array([nearest(droplets, disc) for disc in discs])
    radii = np.array([disc[2] for disc in discs])
    assert np.mean(np.abs(errors[:, 1] - 1) * radii <= radius_std_px(radii)) >= 0.68
    assert np.mean(errors[:, 0] <= position_std_px(radii)) >= 0.68


@pytest.mark.parametrize(("r", "is_kept"), [(6.4, True), (5.4, True), (4.4, False)])
def test_a_radius_may_leave_the_range_by_its_uncertainty(r, is_kept):
    """Blur makes measured radii too small: without this, droplets just within the range would be lost."""
    frame = draw([(100, 100, r + 0.9)], noise=0.5)
    detector = detector_for(frame, method="paper", radius_min_um=6.0)
    assert isinstance(detector, PaperDetector)
    found = detector.detect(detector.prepare(frame))
    assert (len(found.droplets) == 1) == is_kept
    if not is_kept:
        assert set(found.rejected.reasons) <= {"radius", "duplicate"}
