"""Parameters proposed for a stack: what people get before they know anything about it."""

import numpy as np
import pytest

from dropflow.errors import FramesError
from dropflow.suggest import suggest
from tests.dropflow.detection.discs import draw, experiment

SHAPE = (500, 600)


def film(n_frames, step=(6.0, -4.0), *, n_droplets=70, noise=2.0, contrast=90.0):
    """Droplets of 7 to 30 px that all move alike."""
    rng = np.random.default_rng(5)
    x, y = rng.uniform(0, SHAPE[1], n_droplets), rng.uniform(0, SHAPE[0], n_droplets)
    r = np.exp(rng.uniform(np.log(7), np.log(30), n_droplets))
    places = [(x + i * step[0], y + i * step[1], r) for i in range(n_frames)]
    return [draw(np.column_stack(columns).tolist(), shape=SHAPE, noise=noise, contrast=contrast) for columns in places]


@pytest.fixture(scope="module")
def advice():
    return suggest(film(4), experiment(pixel_size_um=0.5))


def value(advice, name):
    return next(one.value for one in advice.measurements if one.name == name)


def test_what_was_put_in_is_measured(advice):
    assert value(advice, "noise") == pytest.approx(2, rel=0.15)
    assert value(advice, "displacement") == pytest.approx(np.hypot(6, 4), abs=3)
    assert 50 < value(advice, "n_droplets") < 90
    assert 0.7 < value(advice, "blur") < 2.5
    assert value(advice, "contrast") > 30
    assert value(advice, "stripes") == 0
    assert advice.frames == (0, 1, 2)


def test_the_radius_range_holds_all_radii_and_not_much_more(advice):
    detection = advice.parameters().detection
    assert 3.0 <= detection.radius_min_um / 0.5 <= 8
    assert 28 <= detection.radius_max_um / 0.5 <= 60
    assert all(suggestion.reason and suggestion.unit == "um" for suggestion in advice.suggestions)


def test_one_frame_is_enough_for_all_but_displacements():
    advice = suggest(film(1), experiment())
    assert advice.suggestions
    assert "displacement" not in {one.name for one in advice.measurements}


def test_an_empty_field_proposes_nothing_and_says_so():
    noise = np.random.default_rng(0).normal(100, 5, (400, 400)).astype(np.uint8)
    advice = suggest([noise, noise.T.copy()], experiment())
    assert advice.suggestions == ()
    assert advice.parameters().detection.radius_min_um == 4.0
    assert "Only 0 droplets" in advice.warnings[0]


def test_faint_droplets_are_warned_of():
    advice = suggest(film(2, noise=25, contrast=35), experiment())
    assert advice.warnings


@pytest.mark.parametrize(
    ("frames", "code"), [([], "frames.empty"), ([np.zeros((9, 16))], "frames.too_small"), ([np.zeros((1, 1))], None)]
)
def test_what_cannot_be_measured_is_refused(frames, code):
    with pytest.raises(FramesError) as caught:
        suggest(frames, experiment())
    assert caught.value.code == (code or "frames.too_small")
