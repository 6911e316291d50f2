import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dropflow.droplets import Droplets
from dropflow.tracking.first_flow import elect_pairs
from dropflow.tracking.identification import closest_pairs, same_droplets
from tests.dropflow.tracking.generated import droplets_at, film, true_links, vortices

SIMILAR = (0.7, 1.4)


def pair(predicted: Droplets, found: Droplets, reach_px: float = 10.0) -> list[tuple[int, int]]:
    pairs = closest_pairs(predicted, found, reach_px=np.full(len(predicted), reach_px), similar_ratio=SIMILAR)
    return list(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True))


def test_the_closest_pair_comes_first() -> None:
    """The second prediction is nearer to the only droplet in reach of both."""
    assert pair(droplets_at([(0, 0, 5), (6, 0, 5)]), droplets_at([(4, 0, 5)])) == [(1, 0)]


def test_a_closer_droplet_of_another_size_is_passed_over() -> None:
    """Radii must be similar, whatever the distance."""
    assert pair(droplets_at([(0, 0, 5)]), droplets_at([(1, 0, 10), (3, 0, 5.5)])) == [(0, 1)]


def test_nothing_is_paired_out_of_reach() -> None:
    """The reach is a limit."""
    assert pair(droplets_at([(0, 0, 5)]), droplets_at([(11, 0, 5)])) == []
    assert pair(droplets_at([(0, 0, 5)]), Droplets.empty()) == []
    assert pair(Droplets.empty(), droplets_at([(0, 0, 5)])) == []


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**31), st.integers(0, 60), st.integers(0, 60))
def test_each_droplet_is_in_one_pair_at_most(seed: int, n_predicted: int, n_found: int) -> None:
    """And each pair is within reach, with similar radii."""
    rng = np.random.default_rng(seed)
    predicted, found = (
        droplets_at(np.column_stack([rng.uniform(0, 100, (n, 2)), rng.uniform(3, 9, n)]))
        for n in (n_predicted, n_found)
    )
    pairs = closest_pairs(predicted, found, reach_px=np.full(n_predicted, 20.0), similar_ratio=SIMILAR)
    assert len(set(pairs.first.tolist())) == len(set(pairs.second.tolist())) == len(pairs)
    one, other = predicted[pairs.first], found[pairs.second]
    assert (np.hypot(one.x_px - other.x_px, one.y_px - other.y_px) <= 20).all()
    assert (np.abs(np.log(one.r_px / other.r_px)) < np.log(1.43)).all()


def test_a_heap_of_detections_in_one_place_costs_no_square_of_their_number() -> None:
    """Ten thousand droplets at one point are paired with each other, each once."""
    heap = droplets_at(np.tile([50.0, 50.0, 5.0], (10_000, 1)))
    assert len(pair(heap, heap)) <= 10_000


def test_two_sightings_are_one_droplet_when_nearer_than_the_smaller_radius() -> None:
    """A small droplet in front of a big one is another, and so is one further away."""
    these = droplets_at([(0, 0, 10)])
    others = droplets_at([(5, 0, 9), (1, 0, 4), (9.5, 0, 9), (20, 0, 10)])
    assert same_droplets(these, others, SIMILAR).second.tolist() == [0]


def test_the_first_flow_is_found_though_droplets_travel_more_than_their_spacing() -> None:
    """Most displacements are elected rightly with a third of the detections false or missing."""
    given_film = film(
        flow=vortices(15, 600, drift_px_s=(60, -30)), n_frames=2, found_share=0.9, n_false=30, radius_error=0.04
    )
    here, there = given_film.frames
    spacing_px = float(np.sqrt(512 * 612 / len(there)))
    pairs = elect_pairs(here, there, spacing_px=spacing_px)
    true = {(first, second) for _, first, second in true_links(given_film)}
    elected = set(zip(pairs.first.tolist(), pairs.second.tolist(), strict=True))
    assert np.hypot(60, 30) > 1.3 * spacing_px
    assert len(elected & true) > 0.9 * len(elected)
    assert len(elected & true) > 0.8 * len(true)


@pytest.mark.parametrize("seed", range(4))
def test_of_droplets_that_share_no_motion_none_is_elected(seed: int) -> None:
    """Random places in both frames have neighbours that agree by chance alone."""
    rng = np.random.default_rng(seed)
    here, there = (
        droplets_at(np.column_stack([rng.uniform(0, 600, (200, 2)), rng.uniform(4, 9, 200)])) for _ in range(2)
    )
    pairs = elect_pairs(here, there, spacing_px=42.0)
    assert len(pairs) == 0


def test_a_single_droplet_elects_nothing() -> None:
    """There is nobody to agree with."""
    one = droplets_at([(5, 5, 5)])
    assert len(elect_pairs(one, one, spacing_px=10.0)) == 0
