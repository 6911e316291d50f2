"""Stripes of light and shadow behind droplets, as seen from the lamp on the right (section 2.2)."""

import numba
import numpy as np
import numpy.typing as npt

from dropflow.simulation.cloud import Cloud
from dropflow.simulation.scenario import Scenario

Column = npt.NDArray[np.float64]
Picture = npt.NDArray[np.float32]

_N_UPSTREAM_WAVES = 48
_UPSTREAM_WIDTH_UM = 8.0
_UPSTREAM_TIME_S = 5.0
_FINEST_STREAK_PX = 1.5
"""The lamp is not a point: no streak is finer than this (standard deviation)."""


def upstream_streaks(scenario: Scenario, time_s: float, seed: int) -> Picture:
    """Relative change of the light that enters at the right border, by row: what droplets beyond it did."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x57]))
    wave_per_px = rng.standard_normal(_N_UPSTREAM_WAVES) * scenario.pixel_size_um / _UPSTREAM_WIDTH_UM
    phase = rng.uniform(0, 2 * np.pi, _N_UPSTREAM_WAVES) + rng.standard_normal(_N_UPSTREAM_WAVES) * (
        time_s / _UPSTREAM_TIME_S
    )
    rows = np.arange(scenario.height_px)[:, None]
    waves = np.cos(rows * wave_per_px + phase).sum(axis=1) * np.sqrt(2.0 / _N_UPSTREAM_WAVES)
    return np.asarray(scenario.streak_upstream * scenario.streak_amplitude * waves, np.float32)


def streaks(cloud: Cloud, upstream: Picture, scenario: Scenario) -> Picture:
    """Relative change of the light over the frame, shape (height, width).

    Each lit droplet adds a profile over its rows, which runs to the left, fades and widens. The droplet is a poor
    lens: a bright line in the middle and a shadow on both sides, stronger or weaker by droplet.
    """
    source = np.zeros((scenario.width_px, scenario.height_px), np.float32)
    pixel = scenario.pixel_size_um
    strength = scenario.streak_amplitude * _character(cloud.droplet_id)
    strength *= np.exp(-0.5 * (cloud.z_um / scenario.sheet_sigma_um) ** 2)
    decay = np.exp(-pixel / scenario.streak_length_um)
    _add_sources(source, cloud.x_um / pixel, cloud.y_um / pixel, cloud.r_um / pixel, strength, decay)
    source[-1] += upstream
    _run_left(source, np.float32(decay), np.float32(scenario.streak_spread_px2))
    return source.T


def _character(droplet_id: npt.NDArray[np.int64]) -> Column:
    """A factor from 0.3 to 1.7 that stays with a droplet."""
    return np.asarray(0.3 + 1.4 * ((droplet_id * 0.6180339887498949) % 1.0), np.float64)


@numba.njit(cache=True, error_model="numpy")
def _add_sources(source: Picture, x: Column, y: Column, r: Column, strength: Column, decay: float) -> None:
    """The change of light grows evenly along the way through the droplet, from its right edge to its left one."""
    width, height = source.shape
    for i in range(x.size):
        right, left = int(np.ceil(x[i] + 0.7 * r[i])), int(np.floor(x[i] - 0.7 * r[i]))
        if right < 0 or left - width > 5.0 / (1.0 - decay):
            continue
        core = max(0.22 * r[i], _FINEST_STREAK_PX)
        reach = max(2.0 * r[i], 4.0 * core)
        top, bottom = max(int(y[i] - reach), 0), min(int(y[i] + reach) + 1, height - 1)
        for row in range(top, bottom + 1):
            d2 = (row - y[i]) ** 2
            bright = 1.3 * (0.22 * r[i] / core) * np.exp(-0.5 * d2 / (core * core))
            shadow = 0.55 * np.exp(-0.5 * d2 / (0.36 * r[i] * r[i]))
            change = strength[i] * (bright - shadow) / (right - left + 1)
            for column in range(left, right + 1):
                if column >= width:
                    source[width - 1, row] += change * decay ** (column - width + 1)
                elif column >= 0:
                    source[column, row] += change


@numba.njit(cache=True, error_model="numpy")
def _run_left(source: Picture, decay: np.float32, spread: np.float32) -> None:
    """Carry the light from each column to the one on its left, in place; columns are rows of `source` here."""
    width, height = source.shape
    two = np.float32(2.0)
    for column in range(width - 2, -1, -1):
        for row in range(height):
            here = source[column + 1, row]
            above = source[column + 1, max(row - 1, 0)]
            below = source[column + 1, min(row + 1, height - 1)]
            source[column, row] += decay * (here + spread * (above - two * here + below))
