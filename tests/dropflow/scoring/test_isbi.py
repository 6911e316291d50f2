import numpy as np
import pytest

from dropflow.scoring import IsbiScore, match_to_truth, score_isbi
from dropflow.scoring.isbi import Tracks, compare_tracks
from tests.dropflow.scoring.hand_made import as_results, results, straight_paths, truth

PATHS = straight_paths(4, 10)


def _score(found: list[dict], real: list[dict] = PATHS) -> IsbiScore:
    return score_isbi(match_to_truth(results(found), truth(real)))


def test_the_truth_itself_scores_one() -> None:
    score = _score(as_results(PATHS))
    assert score == IsbiScore(alpha=1, beta=1, jsc=1, jsc_theta=1, rmse_px=0)


def test_a_shift_costs_its_share_of_the_gate() -> None:
    score = _score([row | {"x_px": row["x_px"] + 2.0} for row in as_results(PATHS)])
    assert (score.alpha, score.beta) == pytest.approx((0.6, 0.6))
    assert (score.jsc, score.jsc_theta, score.rmse_px) == pytest.approx((1, 1, 2))


def test_a_shift_past_the_gate_is_no_match_at_all() -> None:
    score = _score([row | {"x_px": row["x_px"] + 5.0} for row in as_results(PATHS)])
    assert (score.alpha, score.beta, score.jsc, score.jsc_theta, score.rmse_px) == (0, 0, 0, 0, None)


def test_a_missed_track_and_a_spurious_one() -> None:
    ghost = [{"frame": frame, "x_px": 900.0, "trajectory_id": 99} for frame in range(10)]
    score = _score([row for row in as_results(PATHS) if row["trajectory_id"] != 0] + ghost)
    assert score.alpha == pytest.approx(0.75)
    assert score.beta == pytest.approx(0.75 * 40 / 50)
    assert score.jsc == pytest.approx(30 / 50)
    assert score.jsc_theta == pytest.approx(3 / 5)


def test_a_broken_track_is_covered_by_its_longer_part() -> None:
    broken = [
        row | ({"trajectory_id": 99} if row["trajectory_id"] == 0 and row["frame"] >= 7 else {})
        for row in as_results(PATHS)
    ]
    score = _score(broken)
    assert score.alpha == pytest.approx(37 / 40)
    assert score.beta == pytest.approx(37 / 43)
    assert score.jsc == pytest.approx(37 / 43)
    assert score.jsc_theta == pytest.approx(4 / 5)


def test_swapped_identities_halve_two_tracks() -> None:
    swapped = [
        row | ({"trajectory_id": 1 - row["trajectory_id"]} if row["trajectory_id"] < 2 and row["frame"] >= 6 else {})
        for row in as_results(PATHS)
    ]
    score = _score(swapped)
    # In 4 of 10 frames both tracks are 100 px from the right place: the gate counts, once.
    assert score.alpha == pytest.approx((2 * 10 + 2 * 6) / 40)
    assert score.jsc == pytest.approx(32 / 48)


def test_a_track_that_is_longer_than_the_truth_pays_for_the_rest() -> None:
    longer = as_results(straight_paths(4, 12))
    score = _score(longer)
    assert score.alpha == pytest.approx(8 / 10)
    assert score.jsc == pytest.approx(40 / 48)


def test_borderline_places_count_neither_way() -> None:
    real = [row | ({"visibility": "borderline"} if row["frame"] >= 8 else {}) for row in PATHS]
    assert _score(as_results(PATHS), real).alpha == 1
    assert _score(as_results(PATHS), real).jsc == 1
    assert _score([row for row in as_results(PATHS) if row["frame"] < 8], real).beta == 1


def test_pairs_of_tracks_are_the_best_of_all() -> None:
    rng = np.random.default_rng(3)
    for _ in range(30):
        real, found = (_random_tracks(rng) for _ in range(2))
        assert compare_tracks(real, found).alpha == pytest.approx(_alpha_by_trying_all(real, found))


def _random_tracks(rng: np.random.Generator) -> Tracks:
    rows = [(track, frame) for track in range(3) for frame in range(5) if rng.random() < 0.8]
    track, frame = np.array([(0, 9), (1, 9), (2, 9), *rows]).T
    return Tracks(track, frame, rng.uniform(0, 6, (len(track), 2)))


def _alpha_by_trying_all(real: Tracks, found: Tracks, gate: float = 5.0) -> float:
    from itertools import permutations

    def distance(i: int, j: int | None) -> float:
        one = {f: p for t, f, p in zip(real.track, real.frame, real.place_px, strict=True) if t == i}
        other = {f: p for t, f, p in zip(found.track, found.frame, found.place_px, strict=True) if t == j}
        both = one.keys() & other.keys()
        near = sum(min(float(np.hypot(*(one[f] - other[f]))), gate) for f in both)
        return near + gate * (len(one.keys() | other.keys()) - len(both))

    nothing = sum(distance(i, None) for i in range(3))
    best = min(sum(distance(i, j) for i, j in enumerate(way)) for way in permutations([0, 1, 2, None, None, None], 3))
    return 1 - best / nothing


def test_where_nothing_is_there_numbers_are_none() -> None:
    assert _score([], []) == IsbiScore(None, None, None, None, None)
    assert _score([]).alpha == 0
    assert _score(as_results(PATHS), []).alpha is None
