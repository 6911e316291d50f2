import pyarrow as pa
import pytest

from dropflow.scoring import match_to_truth, score_size_distribution
from tests.dropflow.scoring.hand_made import as_results, results, straight_paths, truth

PATHS = straight_paths(4, 5)


def _score(found: list[dict], real: list[dict] = PATHS):
    return score_size_distribution(match_to_truth(results(found), truth(real)))


def test_the_truth_itself_has_no_distance() -> None:
    score = _score(as_results(PATHS))
    assert (score.l1, score.l1_shape) == (0, 0)


def test_false_droplets_count_by_their_number() -> None:
    ghosts = [{"frame": frame, "x_px": 900.0, "r_px": 70.0} for frame in range(5)]
    score = _score([*as_results(PATHS), *ghosts])
    assert score.l1 == pytest.approx(5 / 20)
    assert score.l1_shape == pytest.approx(2 * 5 / 25)


def test_droplets_missed_alike_change_the_number_but_not_the_shape() -> None:
    score = _score([row for row in as_results(PATHS) if row["frame"] != 0])
    assert score.l1 == pytest.approx(4 / 20)
    assert score.l1_shape == pytest.approx(0)


def test_wrong_radii_count_twice() -> None:
    score = _score([row | ({"r_px": 12.0} if row["trajectory_id"] == 0 else {}) for row in as_results(PATHS)])
    assert score.l1 == pytest.approx(10 / 20)


def test_borderline_droplets_count_neither_way() -> None:
    real = [row | ({"visibility": "borderline"} if row["droplet_id"] == 3 else {}) for row in PATHS]
    assert _score(as_results(PATHS), real).l1 == 0


def test_real_droplets_that_are_not_visible_count_as_false_but_can_be_left_out() -> None:
    real = [row | ({"visibility": "not"} if row["droplet_id"] == 3 else {}) for row in PATHS]
    score = _score(as_results(PATHS), real)
    assert (score.l1, score.l1_any) == (5 / 15, 0)


def test_no_result_at_all_gives_one() -> None:
    score = _score([])
    assert (score.l1, score.l1_shape) == (1, None)


def test_radii_count_with_their_errors_and_droplets_with_their_weights() -> None:
    """Half of each droplet leaves half of the distance; an error that reaches over the edge of a bin adds some."""
    table = results(as_results(PATHS))
    half = table.append_column("weight", pa.array([0.5] * len(table)))
    assert score_size_distribution(match_to_truth(half, truth(PATHS))).l1 == pytest.approx(0.5)
    wide = table.append_column("r_std_um", pa.array([1.0] * len(table)))
    assert 0.1 < score_size_distribution(match_to_truth(wide, truth(PATHS))).l1 < 1.9
