"""When two circles are one droplet, as properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dropflow.detection.paper.duplicates import is_similar, is_unique
from dropflow.parameters import PaperDetection

KNOBS = PaperDetection()
CIRCLES = st.lists(
    st.tuples(st.floats(0, 60), st.floats(0, 60), st.floats(2, 30), st.floats(-1, 5)),
    max_size=25,
    unique_by=lambda c: c[3],
)


def columns(circles):
    return [np.array(column, float) for column in zip(*circles, strict=True)] or [np.empty(0)] * 4


def is_same(a, b):
    """The rule, one pair at a time."""
    near = np.hypot(a[0] - b[0], a[1] - b[1]) < min(a[2], b[2])
    return near and (0.7 < a[2] / b[2] < 1.4 or 0.7 < b[2] / a[2] < 1.4)


@given(CIRCLES)
def test_no_two_that_stay_are_one_droplet(circles):
    stays = is_unique(*columns(circles), knobs=KNOBS)
    kept = [circle for circle, stay in zip(circles, stays, strict=True) if stay]
    assert not any(is_same(a, b) for i, a in enumerate(kept) for b in kept[:i])


@given(CIRCLES)
def test_one_that_goes_is_the_droplet_of_a_better_one_that_stays(circles):
    stays = is_unique(*columns(circles), knobs=KNOBS)
    kept = [circle for circle, stay in zip(circles, stays, strict=True) if stay]
    for circle, stay in zip(circles, stays, strict=True):
        assert stay or any(is_same(circle, other) and other[3] > circle[3] for other in kept)


@given(CIRCLES)
def test_a_second_time_changes_nothing(circles):
    stays = is_unique(*columns(circles), knobs=KNOBS)
    assert is_unique(*[column[stays] for column in columns(circles)], knobs=KNOBS).all()


@given(CIRCLES, st.randoms(use_true_random=False))
def test_the_order_does_not_matter(circles, random):
    shuffled = list(circles)
    random.shuffle(shuffled)
    kept, kept_shuffled = (
        {c for c, stay in zip(listed, is_unique(*columns(listed), knobs=KNOBS), strict=True) if stay}
        for listed in (circles, shuffled)
    )
    assert kept == kept_shuffled


@given(CIRCLES)
def test_the_best_match_always_stays(circles):
    stays = is_unique(*columns(circles), knobs=KNOBS)
    assert not circles or stays[int(np.argmax([circle[3] for circle in circles]))]


@pytest.mark.parametrize(
    ("other", "is_duplicate"),
    [
        ((9.9, 0, 10), True),
        ((10.1, 0, 10), False),
        ((0, 0, 7.1), True),
        ((0, 0, 6.9), False),
        ((0, 0, 13.9), True),
        ((0, 0, 14.4), False),
        ((7.5, 0, 7.1), False),
    ],
    ids=["near", "far", "smaller", "much smaller", "larger", "much larger", "one radius is the smaller one"],
)
def test_the_limits_are_the_papers(other, is_duplicate):
    x, y, r = ([first, second] for first, second in zip((0, 0, 10), other, strict=True))
    stays = is_unique(np.array(x, float), np.array(y, float), np.array(r, float), np.array([2.0, 1.0]), knobs=KNOBS)
    assert list(stays) == [True, not is_duplicate]


@given(st.floats(1, 100), st.floats(1, 100))
def test_similar_radii_have_no_order(r, other_r):
    pair = np.array([r]), np.array([other_r])
    assert is_similar(*pair, KNOBS) == is_similar(*pair[::-1], KNOBS)
