"""Small scenes for the tests of the simulation."""

import numpy as np
import numpy.typing as npt

from dropflow.simulation.cloud import Cloud
from dropflow.simulation.scenario import EASY, Scenario, changed


def small(scenario: Scenario = EASY, **constants: object) -> Scenario:
    """A scenario with frames of 192 x 240 px."""
    return changed(scenario, {"height_px": 192, "width_px": 240, **constants})


def clean(**constants: object) -> Scenario:
    """A small scenario in which nothing but droplets changes the light."""
    still = {"gradient": 0, "flicker": 0, "streak_amplitude": 0, "n_dirt": 0, "vignette": 0, "offset_levels": 0}
    return small(**{**still, "read_noise_levels": 0, "electrons_per_level": 1e9, "bit_depth": 16, **constants})


def cloud(*droplets: tuple[float, float, float, float]) -> Cloud:
    """Droplets given as (x_um, y_um, z_um, r_um), with ids from 0."""
    x, y, z, r = np.array(droplets, np.float64).reshape(-1, 4).T
    n = len(droplets)
    return Cloud(np.arange(n), x, y, z, r, np.zeros(n, np.int8))


def slope(x: npt.NDArray[np.float64], y: npt.NDArray[np.float64]) -> float:
    """Slope of the straight line through the origin that fits y(x) best."""
    return float(np.sum(x * y) / np.sum(x * x))
