"""Eq. 3 on disks whose match can be written down, and the climb to its maximum."""

import numpy as np
import pytest

from dropflow.detection.paper.match import climb, match
from dropflow.parameters import PaperDetection

KNOBS = PaperDetection()


def step_disk(x, y, r, *, inside=200.0, outside=40.0, shape=(160, 200)):
    """An antialiased disk of one level on a ground of another."""
    rows, columns = np.indices(shape)
    coverage = np.clip(r + 0.5 - np.hypot(columns - x, rows - y), 0, 1)
    return (outside + (inside - outside) * coverage).astype(np.float32)


def one(image, x, y, r, knobs=KNOBS):
    return float(match(image, *(np.array([float(value)]) for value in (x, y, r)), knobs=knobs)[0])


def climbed(image, x, y, r, *, r_low_px=3.0, r_high_px=60.0):
    start = (np.array([float(value)]) for value in (x, y, r))
    return [float(v[0]) for v in climb(image, *start, r_low_px=r_low_px, r_high_px=r_high_px, knobs=KNOBS)]


@pytest.mark.parametrize("r", [4.0, 9.5, 20.0, 45.3])
def test_a_step_disk_has_the_match_of_equation_3(r):
    """A(r) times the step; the antialiased edge takes the share 1 / (4 r) from the disk and 1 / 18 from the ring."""
    image = step_disk(95.3, 80.7, r)
    ideal = 160 / (30 + r**1.3)
    edge = 1 - 1 / (3 * r) - 2 * np.pi * r / 6 / (np.pi * ((r + 3) ** 2 - r**2))
    assert one(image, 95.3, 80.7, r) == pytest.approx(ideal * edge, rel=0.02)


def test_the_prefactor_has_the_constants_of_the_parameters():
    image = step_disk(95, 80, 20)
    heavier = PaperDetection(match_offset=60.0, match_exponent=0.5)
    assert one(image, 95, 80, 20, heavier) == pytest.approx(
        one(image, 95, 80, 20) * (30 + 20**1.3) / (60 + 20**0.5), rel=1e-6
    )


def test_a_flat_frame_has_no_match():
    assert one(np.full((100, 100), 80, np.float32), 50.2, 49.7, 12) == pytest.approx(0, abs=1e-4)


def test_a_dark_disk_has_a_negative_match():
    assert one(step_disk(95, 80, 20, inside=40, outside=200), 95, 80, 20) < -1


def test_an_uneven_ring_costs_b_times_its_centroid_squared():
    """Half of the ring at 100, half at 300: its centroid is (mean radius of the ring) * (100 / 400) * 2 / pi away."""
    _, columns = np.indices((120, 120))
    image = np.where(columns > 60, 300, np.where(columns < 60, 100, 200)).astype(np.float32)
    r = 30.0
    shift = (r + 1.5) * 0.5 * 2 / np.pi
    without = one(image, 60, 60, r, PaperDetection(match_asymmetry=0.0))
    assert without == pytest.approx(0, abs=0.01)
    assert one(image, 60, 60, r) == pytest.approx(-3 * (shift / r) ** 2, rel=0.02)


def test_the_border_alone_is_no_asymmetry():
    """A disk cut by the border keeps the match of a whole one: its visible ring is compared with itself."""
    whole, cut = one(step_disk(95, 80, 20), 95, 80, 20), one(step_disk(8, 80, 20), 8, 80, 20)
    assert cut == pytest.approx(whole, rel=0.02)


@pytest.mark.parametrize("place", [(-0.6, 50), (199.6, 50), (50, -0.6), (50, 159.6), (-500, 50)])
def test_outside_the_frame_there_is_no_match(place):
    assert one(step_disk(95, 80, 20), *place, 10) == -np.inf


def test_a_disk_that_fills_the_frame_has_no_match():
    assert one(np.full((9, 9), 50, np.float32), 4, 4, 30) == -np.inf


def test_the_match_is_continuous():
    """No step when disk and ring move over pixel borders: the climb would end on it."""
    image = step_disk(95.3, 80.7, 14)
    x = np.linspace(94, 97, 3001)
    matches = match(image, x, np.full_like(x, 80.2), np.full_like(x, 13.3), knobs=KNOBS)
    assert np.abs(np.diff(matches)).max() < 3e-3


@pytest.mark.parametrize("r", [5.0, 12.0, 30.0])
@pytest.mark.parametrize("off", [(0.2, -0.1, 1.2), (-0.2, 0.1, 0.9), (0, 0.3, 1.1)])
def test_the_climb_finds_the_disk(r, off):
    image = step_disk(95.3, 80.7, r)
    x, y, found_r, best = climbed(image, 95.3 + off[0] * r, 80.7 + off[1] * r, off[2] * r)
    assert (x, y) == pytest.approx((95.3, 80.7), abs=0.1)
    assert found_r == pytest.approx(r, abs=0.4)
    assert best >= one(image, 95.3, 80.7, r)


def test_the_climb_never_ends_lower_than_it_began():
    rng = np.random.default_rng(5)
    image = rng.uniform(0, 255, (160, 200)).astype(np.float32)
    x, y, r = rng.uniform(0, 199, 200), rng.uniform(0, 159, 200), rng.uniform(3, 30, 200)
    before = match(image, x, y, r, knobs=KNOBS)
    *_, after = climb(image, x, y, r, r_low_px=3, r_high_px=30, knobs=KNOBS)
    assert (after >= before).all()


def test_the_climb_keeps_the_radius_in_its_limits():
    *_, r, _ = climbed(step_disk(95, 80, 30), 95, 80, 12, r_high_px=20)
    assert r <= 20
    *_, r, _ = climbed(step_disk(95, 80, 5), 95, 80, 12, r_low_px=8)
    assert r >= 8


def test_nothing_in_nothing_out():
    nothing = np.empty(0)
    assert match(np.zeros((9, 9), np.float32), nothing, nothing, nothing, knobs=KNOBS).shape == (0,)
    found = climb(np.zeros((9, 9), np.float32), nothing, nothing, nothing, r_low_px=3, r_high_px=4, knobs=KNOBS)
    assert [column.shape for column in found] == [(0,)] * 4


def test_circles_climb_alike_together_and_alone():
    """What a climb remembers is its own, and what it reports is the match of where it ends."""
    image = step_disk(95.3, 80.7, 20.0) + step_disk(140.0, 60.0, 9.0, outside=0.0)
    rng = np.random.default_rng(3)
    x, y, r = rng.uniform(60, 150, 40), rng.uniform(40, 110, 40), rng.uniform(4, 30, 40)
    together = np.array(climb(image, x, y, r, r_low_px=3.0, r_high_px=60.0, knobs=KNOBS))
    alone = np.array([climbed(image, *start) for start in zip(x, y, r, strict=True)]).T
    assert np.array_equal(together, alone)
    assert match(image, *together[:3], knobs=KNOBS) == pytest.approx(together[3], abs=1e-6)
