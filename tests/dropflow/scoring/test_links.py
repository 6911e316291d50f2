from dropflow.scoring import LinkScore, match_to_truth, score_links
from tests.dropflow.scoring.hand_made import as_results, results, straight_paths, truth

PATHS = straight_paths(4, 6)


def _score(found: list[dict], real: list[dict], products: dict[int, int] | None = None) -> LinkScore:
    return score_links(match_to_truth(results(found), truth(real)), products)


def _changed(rows: list[dict], changes: dict[tuple[int, int], int]) -> list[dict]:
    """Rows with another trajectory at (frame, trajectory)."""
    return [
        row | {"trajectory_id": changes.get((row["frame"], row["trajectory_id"]), row["trajectory_id"])} for row in rows
    ]


def test_the_truth_itself_scores_one() -> None:
    score = _score(as_results(PATHS), PATHS)
    assert (score.precision, score.recall, score.n_links) == (1, 1, 20)


def test_the_order_of_rows_does_not_matter() -> None:
    rows = sorted(as_results(PATHS), key=lambda row: (row["trajectory_id"], -row["frame"]))
    assert _score(rows, PATHS) == _score(as_results(PATHS), PATHS)


def test_swapped_identities_cost_the_two_links_of_the_swap() -> None:
    swap = {(frame, i): 1 - i for frame in range(3, 6) for i in (0, 1)}
    score = _score(_changed(as_results(PATHS), swap), PATHS)
    assert (score.precision, score.recall) == (18 / 20, 18 / 20)


def test_a_missed_droplet_costs_both_its_links_in_recall_alone() -> None:
    found = [row for row in as_results(PATHS) if (row["frame"], row["trajectory_id"]) != (2, 0)]
    score = _score(found, PATHS)
    assert (score.precision, score.recall) == (1, 18 / 20)


def test_a_broken_trajectory_costs_one_link_in_recall_alone() -> None:
    score = _score(_changed(as_results(PATHS), {(frame, 0): 77 for frame in (3, 4, 5)}), PATHS)
    assert (score.precision, score.recall) == (1, 19 / 20)


def test_links_of_false_droplets_cost_precision_alone() -> None:
    ghost = [{"frame": frame, "x_px": 900.0, "trajectory_id": 99} for frame in range(6)]
    score = _score([*as_results(PATHS), *ghost], PATHS)
    assert (score.precision, score.recall) == (20 / 25, 1)


def test_links_at_borderline_droplets_are_neutral_right_or_wrong() -> None:
    real = [row | ({"visibility": "borderline"} if row["droplet_id"] == 0 else {}) for row in PATHS]
    followed = _score(as_results(PATHS), real)
    assert (followed.precision, followed.recall, followed.n_neutral, followed.n_true_links) == (1, 1, 5, 15)
    onto_it = _changed(as_results(PATHS), {(frame, i): 1 - i for frame in range(3, 6) for i in (0, 1)})
    swapped = _score(onto_it, real)
    assert (swapped.precision, swapped.recall) == (1, 14 / 15)


def test_a_droplet_that_is_not_visible_may_be_followed_but_need_not() -> None:
    real = [row | ({"visibility": "not"} if row["droplet_id"] == 0 else {}) for row in PATHS]
    assert _score(as_results(PATHS), real).precision == 1
    without = [row for row in as_results(PATHS) if row["trajectory_id"] != 0]
    assert _score(without, real).recall == 1


def test_a_link_into_the_product_of_a_coalescence_is_neutral() -> None:
    real = [row | ({"droplet_id": 50} if row["droplet_id"] == 0 and row["frame"] >= 3 else {}) for row in PATHS]
    found = as_results(PATHS)
    assert _score(found, real).precision == 19 / 20
    score = _score(found, real, {0: 50, 9: 50})
    assert (score.precision, score.recall, score.n_neutral) == (1, 1, 1)
    assert _score(found, real, {0: 40, 40: 50}).precision == 1
    assert _score(found, real, {0: 40}).precision == 19 / 20


def test_a_step_over_a_missing_frame_is_no_link() -> None:
    found = [row for row in as_results(PATHS) if row["frame"] % 2 == 0]
    assert _score(found, PATHS).n_links == 0
