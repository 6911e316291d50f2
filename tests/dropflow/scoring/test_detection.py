import numpy as np
import pytest

from dropflow.scoring import DetectionScore, match_to_truth, score_detection
from tests.dropflow.scoring.hand_made import as_results, results, straight_paths, truth

PATHS = straight_paths(5, 4)


def _score(found: list[dict], real: list[dict]) -> DetectionScore:
    return score_detection(match_to_truth(results(found), truth(real)))


def test_the_truth_itself_scores_one() -> None:
    score = _score(as_results(PATHS), PATHS)
    assert (score.precision, score.precision_any, score.recall, score.f1) == (1, 1, 1, 1)
    assert (score.radius_bias_percent, score.radius_sd_percent, score.position_median_px) == (0, 0, 0)
    assert (score.r_coverage, score.x_coverage) == (1, 1)


def test_missed_droplets_cost_recall_alone() -> None:
    score = _score([row for row in as_results(PATHS) if row["trajectory_id"] != 0], PATHS)
    assert (score.precision, score.recall) == (1, 0.8)
    assert score.f1 == pytest.approx(2 * 0.8 / 1.8)


def test_false_droplets_cost_precision_alone() -> None:
    score = _score([*as_results(PATHS), *({"frame": i, "x_px": 900.0} for i in range(4)), {"x_px": 990.0}], PATHS)
    assert (score.precision, score.precision_any, score.recall) == (0.8, 0.8, 1)
    assert score.n_false == 5


def test_a_second_result_for_one_droplet_is_false() -> None:
    score = _score([*as_results(PATHS), as_results(PATHS)[0]], PATHS)
    assert (score.n_right, score.n_false) == (20, 1)


def test_borderline_droplets_count_neither_way_and_invisible_ones_as_false() -> None:
    real = [
        {"x_px": 0.0, "visibility": "visible"},
        {"x_px": 100.0, "visibility": "borderline"},
        {"x_px": 200.0, "visibility": "not"},
        {"x_px": 300.0, "visibility": "borderline"},
        {"x_px": 400.0, "visibility": "not"},
    ]
    score = _score([{"x_px": x} for x in (0.0, 100.0, 200.0, 600.0)], real)
    assert (score.n_right, score.n_borderline, score.n_not_visible, score.n_false) == (1, 1, 1, 1)
    assert (score.precision, score.precision_any, score.recall) == (1 / 3, 3 / 4, 1)


def test_recall_is_told_by_radius_class() -> None:
    real = [{"x_px": 200.0 * i, "r_px": r} for i, r in enumerate((9.9, 10.0, 15.9, 16.0, 31.9, 32.0, 60.0))]
    found = [{"x_px": row["x_px"], "r_px": row["r_px"]} for row in real if row["r_px"] not in (10.0, 60.0)]
    assert _score(found, real).recall_by_radius_px == {"<10": 1.0, "10-16": 0.5, "16-32": 1.0, ">=32": 0.5}
    assert _score([], real[:1]).recall_by_radius_px == {"<10": 0.0, "10-16": None, "16-32": None, ">=32": None}


def test_errors_of_radius_and_position_are_measured() -> None:
    rng = np.random.default_rng(0)
    n = 4000
    real = [{"frame": i, "r_px": 20.0} for i in range(n)]
    error = rng.normal(-0.6, 0.8, n)
    found = [
        {"frame": i, "r_px": 20.0 + error[i], "x_px": 0.3, "y_px": 0.4, "r_std_px": 1.0, "x_std_px": 0.35}
        for i in range(n)
    ]
    score = _score(found, real)
    assert score.radius_bias_percent == pytest.approx(-3.0, abs=0.2)
    assert score.radius_sd_percent == pytest.approx(4.0, abs=0.2)
    assert score.radius_robust_sd_percent == pytest.approx(4.0, abs=0.2)
    assert score.position_median_px == pytest.approx(0.5)
    assert score.r_coverage == pytest.approx(np.mean(np.abs(error) <= 1.0))
    assert score.x_coverage == 0.5


def test_where_nothing_is_there_numbers_are_none() -> None:
    score = _score([], [])
    assert (score.precision, score.recall, score.f1, score.radius_bias_percent) == (None, None, None, None)
