"""Places where far fewer droplets than usual are found."""

import numpy as np
import numpy.typing as npt

from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.lost_places import lost_places

SIDE_PX = 1000.0


def places(n: int = 400) -> npt.NDArray[np.float64]:
    return np.random.default_rng(3).uniform(0, SIDE_PX, (2, n))


def seen_at(x_px: list[float], y_px: list[float]) -> Observations:
    n = np.zeros(len(x_px))
    return Observations(np.array(x_px), np.array(y_px), n, n, n, n, n, n)


def test_a_place_where_nearly_all_are_missing_is_lost_and_nothing_else() -> None:
    """Nine in ten are found elsewhere, one in ten there."""
    x, y = places()
    there = np.hypot(x - 300, y - 700) < 160
    chance = np.random.default_rng(4).random(len(x))
    lost = lost_places(x, y, chance < np.where(there, 0.1, 0.9))
    assert lost is not None
    assert lost.is_lost[np.hypot(x - 300, y - 700) < 110].all()
    assert not lost.is_lost[np.hypot(x - 300, y - 700) > 260].any()
    left = lost.without(seen_at([300.0, 800.0], [700.0, 200.0]))
    np.testing.assert_array_equal(left.x_px, [800.0])


def test_what_is_missing_here_and_there_is_chance() -> None:
    """Whatever share is usual: in one frame in five at most, rarely in one more."""
    x, y = places()
    rng = np.random.default_rng(5)
    for share in (0.98, 0.9, 0.7, 0.4, 0.1):
        assert sum(lost_places(x, y, rng.random(len(x)) < share) is not None for _ in range(20)) <= 6


def test_few_droplets_say_nothing() -> None:
    """None, one, three, and all missing or all found."""
    for n in (0, 1, 3, 40):
        x, y = places(n) if n else (np.empty(0), np.empty(0))
        assert lost_places(x, y, np.zeros(n, bool)) is None
        assert lost_places(x, y, np.ones(n, bool)) is None


def test_nothing_seen_stays_nothing() -> None:
    """An empty step."""
    x, y = places()
    lost = lost_places(x, y, np.hypot(x - 300, y - 700) > 200)
    assert lost is not None
    assert len(lost.without(seen_at([], []))) == 0
