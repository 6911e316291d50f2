import numpy as np
import pytest

from dropflow.simulation.wakes import wake_um_s
from tests.dropflow.simulation.scenes import cloud

UP = (0.0, -1.0)


def _wake(*droplets: tuple[float, float, float, float], rise: list[float], range_um: float = 1e6) -> np.ndarray:
    return wake_um_s(cloud(*droplets), np.array(rise), UP, strength=1.0, range_um=range_um)


def test_far_from_a_rising_droplet_the_fluid_moves_as_around_a_point_force() -> None:
    wake = _wake((0, 0, 0, 10), (0, -100, 0, 1), (100, 0, 0, 1), rise=[50.0, 0.0, 0.0])
    # 3/4 r U / d, twice of it straight ahead.
    assert wake[:, 1] == pytest.approx([0, -2 * 0.75 * 10 * 50 / 100, 0], abs=1e-6)
    assert wake[:, 2] == pytest.approx([0, -0.75 * 10 * 50 / 100, 0], abs=1e-6)
    assert wake[:, 0] == pytest.approx([0, 0, 0])


def test_a_droplet_below_is_drawn_along_and_pushed_aside_by_geometry_alone() -> None:
    wake = _wake((0, 0, 0, 10), (60, 80, 0, 1), rise=[50.0, 0.0])
    along = -0.8  # up . e
    expected = 0.75 * 10 * 50 / 100 * np.array([along * 0.6, -1 + along * 0.8, 0.0])
    assert wake[:, 1] == pytest.approx(expected, abs=1e-6)


def test_nothing_is_felt_beyond_the_range() -> None:
    assert np.all(_wake((0, 0, 0, 10), (0, 151, 0, 5), rise=[50.0, 12.0], range_um=150.0) == 0)
