"""The depth of field, from the matches of a film's trajectories."""

import numpy as np
import pyarrow as pa
import pytest

from dropflow.tracking.focus import MatchCensus, mean_matches


def least(match: list[float], n_frames: list[int] | None = None) -> float:
    census = MatchCensus()
    census.add(np.array(match), np.array(n_frames or [5] * len(match)))
    return census.least_match()


def test_the_depth_of_field_ends_at_half_of_the_match_in_focus() -> None:
    """Whatever the scale of the match is."""
    rng = np.random.default_rng(0)
    sharp, blurred = np.exp(rng.normal(np.log(0.6), 0.1, 500)), np.exp(rng.normal(np.log(0.15), 0.2, 500))
    found = least([*sharp, *blurred])
    assert found == pytest.approx(0.32, abs=0.03)
    assert least([*(40 * sharp), *(40 * blurred)]) == pytest.approx(40 * found, rel=0.05)


def test_droplets_that_are_all_sharp_are_all_in_focus() -> None:
    """A few that others cover in part show no second class."""
    rng = np.random.default_rng(1)
    assert least([*np.exp(rng.normal(np.log(0.9), 0.1, 970)), *([0.2] * 30)]) == 0.0


def test_a_film_without_matches_or_trajectories_has_no_depth_of_field() -> None:
    """All count there."""
    assert least([]) == 0.0
    assert least([np.nan, 0.0]) == 0.0


def test_the_mean_match_is_that_of_the_whole_trajectory() -> None:
    """Of logarithms, over frames in which it has one."""
    table = pa.table({"trajectory_id": [3, 3, 3, 7], "match": [0.1, 0.4, np.nan, 0.0]})
    found = mean_matches(table)
    np.testing.assert_allclose(found[:3], 0.2)
    assert np.isnan(found[3])
