import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from dropflow.errors import ResultsError
from dropflow.scoring.matching import assign, match_to_truth
from tests.dropflow.scoring.hand_made import results, straight_paths, truth


@pytest.mark.parametrize(
    ("r_px", "found", "is_match"),
    [
        (10.0, (4.9, 0, 10.0), True),
        (10.0, (5.1, 0, 10.0), False),
        (2.0, (2.9, 0, 2.0), True),
        (2.0, (3.1, 0, 2.0), False),
        (10.0, (0, 0, 19.9), True),
        (10.0, (0, 0, 20.1), False),
        (10.0, (0, 0, 5.1), True),
        (10.0, (0, 0, 4.9), False),
        (40.0, (12, 16, 40.0), True),
        (40.0, (12.1, 16, 40.0), False),
    ],
)
def test_a_pair_matches_within_its_gate_and_ratio(
    r_px: float, found: tuple[float, float, float], is_match: bool
) -> None:
    rows, _ = assign(np.array([found]), np.array([[0.0, 0.0, r_px]]))
    assert (len(rows) == 1) is is_match


def test_the_nearer_and_more_similar_of_two_results_gets_the_droplet() -> None:
    found = np.array([[2.0, 0, 10], [1.0, 0, 10], [1.0, 0, 14]])
    assert [part.tolist() for part in assign(found, np.array([[0.0, 0, 10]]))] == [[1], [0]]


def test_as_many_as_possible_are_matched_before_the_cost_counts() -> None:
    found, real = np.array([[0.0, 0, 10], [4.0, 0, 10]]), np.array([[3.9, 0, 10.0], [8.5, 0, 10.0]])
    rows, columns = assign(found, real)
    assert dict(zip(rows.tolist(), columns.tolist(), strict=True)) == {0: 0, 1: 1}


_PLACES = st.lists(
    st.tuples(st.floats(0, 30), st.floats(0, 30), st.sampled_from([2.0, 5.0, 9.0, 16.0])), min_size=1, max_size=12
)


@settings(max_examples=60, deadline=None)
@given(_PLACES, _PLACES)
def test_the_assignment_is_that_of_the_hungarian_method(
    found: list[tuple[float, float, float]], real: list[tuple[float, float, float]]
) -> None:
    f, t = np.array(found), np.array(real)
    distance = np.hypot(f[:, None, 0] - t[None, :, 0], f[:, None, 1] - t[None, :, 1])
    gate = np.maximum(3, 0.5 * t[:, 2])
    ratio = np.abs(np.log(f[:, None, 2] / t[None, :, 2]))
    possible = (distance <= gate) & (ratio <= np.log(2))
    cost = np.where(possible, distance / gate + ratio, 1e4)
    best = cost[linear_sum_assignment(cost)]
    rows, columns = assign(f, t)
    assert np.all(possible[rows, columns])
    assert len(set(rows)) == len(set(columns)) == len(rows) == np.sum(best < 1e3)
    assert np.sum(cost[rows, columns]) == pytest.approx(np.sum(best[best < 1e3]))


def test_frames_are_matched_apart() -> None:
    paths = straight_paths(3, 4)
    shuffled = [{k: row[k] for k in ("frame", "x_px", "y_px", "r_px")} for row in reversed(paths)]
    matching = match_to_truth(results(shuffled), truth(paths))
    assert matching.truth_row.tolist() == list(range(11, -1, -1))
    late = match_to_truth(results([row | {"frame": 9} for row in shuffled]), truth(paths))
    assert late.truth_row.tolist() == [-1] * 12


def test_tables_of_another_kind_are_an_error_that_names_the_column() -> None:
    with pytest.raises(ResultsError, match="truth has no column droplet_id"):
        match_to_truth(results([{}]), truth([{}]).drop_columns("droplet_id"))
    with pytest.raises(ResultsError, match="results has no column r_px"):
        match_to_truth(results([{}]).drop_columns("r_px"), truth([{}]))


def test_nothing_matches_nothing() -> None:
    assert match_to_truth(results([]), truth([])).truth_row.tolist() == []
    assert match_to_truth(results([{}]), truth([])).truth_row.tolist() == [-1]
    assert match_to_truth(results([]), truth([{}])).truth_row.tolist() == []
