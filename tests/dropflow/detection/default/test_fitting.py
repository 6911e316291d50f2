"""Rays, circles and places: what the closer look measures of one droplet whose truth is known."""

import numpy as np
import pytest

from dropflow.detection.default.candidates import find_candidates
from dropflow.detection.default.closer import look_closer
from dropflow.detection.default.explain import explain_away
from dropflow.detection.default.features import EDGE_SHARE, INSIDE, MATCH
from dropflow.detection.default.overlaps import context, is_best_of_its_kind
from dropflow.detection.default.pyramid import doubled, halved, pyramid
from dropflow.detection.default.rays import N_PROFILE, N_RAYS, _median
from tests.dropflow.detection.discs import draw

NOISE = 1.5
SEEDS = range(6)


def drawn(discs, **options):
    return draw(discs, **options).astype(np.float32)


def look(image, x, y, r, r_max_px=40.0, **options):
    levels = pyramid(image, r_max_px)
    columns = (np.array([value], float) for value in (x, y, r))
    return look_closer(levels, NOISE, *columns, **options)


@pytest.mark.parametrize("r", [5.0, 9.3, 16.0, 37.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_circle_started_beside_a_disc_ends_on_it(r, seed):
    x, y = 150 + np.random.default_rng(seed).uniform(-0.5, 0.5, 2)
    start = np.random.default_rng(seed + 100).uniform(-0.15, 0.15, 3) * r
    found_x, found_y, found_r, features = look(drawn([(x, y, r)]), x + start[0], y + start[1], r + start[2])
    assert np.hypot(found_x - x, found_y - y)[0] < 0.15 + 0.01 * r
    assert found_r[0] == pytest.approx(r, rel=0.12, abs=1.0)  # inside by the blur
    assert features[0, EDGE_SHARE] > 0.9
    assert features[0, MATCH] > 0.9
    assert features[0, INSIDE] == 1


def test_there_is_no_circle_in_a_constant_image():
    _, _, _, features = look(np.full((300, 300), 7, np.float32), 150, 150, 20)
    assert np.isnan(features).all()


def test_a_droplet_cut_by_the_border_is_fitted_by_what_is_there():
    x, _, r, features = look(drawn([(4, 150, 30)]), 7, 152, 28)
    assert x[0] == pytest.approx(4, abs=1)
    assert r[0] == pytest.approx(29, abs=1.5)
    assert features[0, INSIDE] < 0.75


def test_votes_meet_where_droplets_are():
    discs = ((60, 70, 9), (180.4, 60.7, 16), (300, 90, 24), (90, 200, 30), (310, 250, 7))
    found = find_candidates(pyramid(drawn(discs), 40), NOISE, r_min_px=5, r_max_px=40, finest_px=10.4, least_votes=0.22)
    for x, y, r in discs:
        near = np.hypot(found.x_px - x, found.y_px - y) / r + np.abs(np.log(found.r_px / r))
        assert near.min() < 0.4


def test_a_droplet_explained_away_leaves_its_neighbour():
    """Of two that overlap, what is left of the image is near to an image of the other alone."""
    both, one = ((150, 150, 26), (190, 150, 22)), ((190, 150, 22),)
    rest = drawn(both, noise=0)
    profiles = np.zeros((1, N_PROFILE), np.float32)
    explain_away(rest, np.array([150.0]), np.array([150.0]), np.array([26.0]), profiles)
    alone = drawn(one, noise=0)
    inside = np.hypot(*(np.indices(rest.shape)[::-1] - np.array([150, 150])[:, None, None])) < 20
    assert profiles[0, 0] > 60
    assert np.abs(rest - alone)[inside].mean() < 0.1 * np.abs(drawn(both, noise=0) - alone)[inside].mean()


@pytest.mark.parametrize("shape", [(64, 80), (65, 81), (3, 3)])
def test_halves_keep_places(shape):
    """The mean of x over a block is the x of its centre."""
    x = np.indices(shape)[1].astype(np.float32)
    smaller = halved(x)
    assert smaller == pytest.approx(np.broadcast_to(2 * np.arange(shape[1] // 2) + 0.5, smaller.shape))
    assert doubled(x)[:, 2:-2] == pytest.approx(
        np.broadcast_to((np.arange(2 * shape[1]) - 0.5) / 2, (2 * shape[0], 2 * shape[1]))[:, 2:-2]
    )


def test_the_best_of_each_group_of_similar_circles_stays():
    x, y, r = np.array([0.0, 1, 2, 50, 50, 51]), np.zeros(6), np.array([10.0, 10, 10, 10, 20, 10])
    kept = is_best_of_its_kind(x, y, r, np.array([1.0, 3, 2, 1, 2, 3]), distance=0.5, ratio=1.35)
    assert kept.tolist() == [False, True, False, False, True, True]


def test_context_tells_rims_and_disks_of_others():
    sure = np.array([[100.0, 100, 30], [300, 300, 10]])
    circles = np.array([[100.0, 100, 30], [100, 100, 10], [200, 200, 5]])
    around = context(*circles.T.copy(), sure, np.array([0, -1, -1]))
    assert around[0, :2].tolist() == [0, 0]  # it does not count as beside itself
    assert around[1, :2].tolist() == [0, 1]  # inside the first one
    assert around[2, :2].tolist() == [0, 0]
    assert around[1, 3] == pytest.approx(np.log(1 / 3))


@pytest.mark.parametrize("n", [1, 2, 7, 23, 24])
def test_the_median_by_counting_is_the_median(n):
    """Of even and odd numbers, and with equal values among them."""
    rng = np.random.default_rng(n)
    for values in (rng.normal(size=N_RAYS), rng.integers(0, 4, N_RAYS).astype(float)):
        assert _median(values.copy(), n) == pytest.approx(np.median(values[:n]))
