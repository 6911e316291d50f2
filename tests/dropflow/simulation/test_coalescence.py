import numpy as np
import pytest

from dropflow.simulation.coalescence import coalesce, merging_pairs, without_early_merges
from tests.dropflow.simulation.scenes import cloud


def test_two_droplets_that_touch_become_one_of_their_volume_at_their_centre() -> None:
    before = cloud((0, 0, 0, 10), (12, 0, 0, 5), (100, 0, 0, 8))
    after, events = coalesce(before, efficiency=1.0, time_s=3.0, next_id=70)
    assert after.droplet_id.tolist() == [2, 70]
    assert np.sum(after.r_um**3) == pytest.approx(np.sum(before.r_um**3))
    assert after.x_um[1] == pytest.approx(12 * 125 / 1125)
    assert [(e.parents, e.product, e.time_s) for e in events] == [((0, 1), 70, 3.0)]


def test_droplets_that_overlap_in_the_picture_but_not_in_space_pass() -> None:
    after, events = coalesce(cloud((0, 0, 0, 10), (2, 0, 16, 5)), efficiency=1.0, time_s=0.0, next_id=2)
    assert len(after) == 2
    assert events == []


def test_a_droplet_takes_part_in_one_event_at_a_time() -> None:
    after, events = coalesce(
        cloud((0, 0, 0, 10), (15, 0, 0, 10), (30, 0, 0, 10)), efficiency=1.0, time_s=0.0, next_id=3
    )
    assert (len(after), len(events)) == (2, 1)


@pytest.mark.parametrize("efficiency", [0.0, 0.1, 0.6])
def test_the_efficiency_is_the_share_of_pairs_that_merge_and_is_decided_once(efficiency: float) -> None:
    rows = np.arange(2000)
    pairs = np.stack([rows % 50 * 100.0 + rows // 1000 * 5, rows // 50 % 20 * 100.0, 0 * rows, 0 * rows + 8.0])
    crowd = cloud(*map(tuple, pairs.T))
    chosen = merging_pairs(crowd, 0, efficiency)
    assert len(chosen) / 1000 == pytest.approx(efficiency, abs=0.04)
    assert np.array_equal(merging_pairs(crowd, 0, efficiency), chosen)


def test_pairs_are_found_whatever_the_order() -> None:
    rng = np.random.default_rng(0)
    crowd = cloud(*map(tuple, np.column_stack([rng.uniform(0, 300, (200, 3)), rng.uniform(3, 20, 200)])))
    places = np.column_stack([crowd.x_um, crowd.y_um, crowd.z_um])
    distance = np.linalg.norm(places[:, None] - places[None], axis=-1)
    touching = np.argwhere(np.triu(distance <= crowd.r_um[:, None] + crowd.r_um[None], 1))
    assert len(touching) > 20
    assert np.array_equal(merging_pairs(crowd, 0, 1.0), touching)


def test_a_new_droplet_that_would_merge_at_once_does_not_come() -> None:
    left = without_early_merges(cloud((0, 0, 0, 10), (100, 0, 0, 10), (5, 0, 0, 4), (50, 0, 0, 4)), 2, 1.0)
    assert left.droplet_id.tolist() == [0, 1, 3]
