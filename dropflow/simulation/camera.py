"""What belongs to the camera and the lamp, not to the droplets: dirt, vignette, gradient, noise, bits."""

import numba
import numpy as np
import numpy.typing as npt

from dropflow.simulation.scenario import FULL_HEIGHT_PX, FULL_WIDTH_PX, Scenario

Picture = npt.NDArray[np.float32]
Grey = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]

_FLAT_FIELD_LEVELS = 180.0
_DARKEST_LEVEL = 0.5
"""Light never falls below this, however many dark droplets overlap."""


def chip_transmission(scenario: Scenario, rng: np.random.Generator) -> Picture:
    """Share of light that dirt and vignette let through: soft elliptic spots on a field that darkens to the corners."""
    height, width = scenario.height_px, scenario.width_px
    y = np.linspace(-1.0, 1.0, height, dtype=np.float32)[:, None]
    x = np.linspace(-1.0, 1.0, width, dtype=np.float32)[None, :]
    chip = 1.0 - scenario.vignette * 0.5 * (x**2 + y**2)
    for _ in range(rng.poisson(scenario.n_dirt * height * width / (FULL_HEIGHT_PX * FULL_WIDTH_PX))):
        radius = scenario.dirt_radius_px * np.exp(0.5 * rng.standard_normal())
        place = rng.uniform(0.0, (width, height))
        _darken(chip, place, radius * np.exp(rng.uniform(-0.4, 0.4, 2)), rng.uniform(0.2, 1.0) * scenario.dirt_depth)
    return chip.astype(np.float32)


def _darken(chip: Picture, place: npt.NDArray[np.float64], radii: npt.NDArray[np.float64], depth: float) -> None:
    reach = 2.0 * radii + 2.0
    left, top = np.maximum(np.floor(place - reach), 0).astype(int)
    right, bottom = (np.ceil(place + reach) + 1).astype(int)
    patch = chip[top:bottom, left:right]
    y, x = np.mgrid[top : top + patch.shape[0], left : left + patch.shape[1]]
    distance = np.hypot((x - place[0]) / radii[0], (y - place[1]) / radii[1])
    patch *= (1.0 - depth / (1.0 + np.exp(np.clip(6.0 * (distance - 1.0), -30.0, 30.0)))).astype(np.float32)


def gradient_light(y_px: npt.ArrayLike, scenario: Scenario) -> npt.NDArray[np.float64]:
    """Light of the sheet by row, over that of the middle row."""
    share = (np.asarray(y_px, np.float64) + 0.5) / scenario.height_px - 0.5
    return 1.0 + scenario.gradient * np.clip(share, -0.5, 0.5)


def flat_field(scenario: Scenario, chip: Picture, rng: np.random.Generator) -> Grey:
    """Picture of the empty, evenly lit chip: what `experiment.yaml` names as `flat_field`."""
    levels = np.float32(_FLAT_FIELD_LEVELS) * chip
    noise = rng.standard_normal(chip.shape, np.float32) / np.float32(np.sqrt(scenario.n_flat_field_frames))
    read = np.float32(scenario.read_noise_levels**2)
    levels += noise * np.sqrt(levels / np.float32(scenario.electrons_per_level) + read)
    return _quantise(levels, scenario)


def exposed(liquid: Picture, light: Picture, chip: Picture, scenario: Scenario, rng: np.random.Generator) -> Grey:
    """The frame as the camera gives it.

    Parameters
    ----------
    liquid : ndarray, float32, shape (height, width)
        How much of the sheet's depth is droplet liquid that can be seen, 0 to about 1.
    light : ndarray, float32, same shape
        Light of the lamp.
    chip : ndarray, float32, same shape
        `chip_transmission`.
    scenario : Scenario
        Levels, noise and bit depth.
    rng : Generator
        For flicker and noise.

    Returns
    -------
    ndarray, uint8 or uint16, same shape
    """
    lamp = 1.0 + scenario.flicker * rng.standard_normal()
    noise = rng.standard_normal(liquid.shape, np.float32)
    _expose(
        liquid,
        light,
        chip,
        noise,
        np.float32(lamp),
        np.float32(scenario.background_levels),
        np.float32(-scenario.contrast_levels if scenario.is_dark else scenario.contrast_levels),
        np.float32(scenario.offset_levels),
        np.float32(1.0 / scenario.electrons_per_level),
        np.float32(scenario.read_noise_levels**2),
    )
    return _quantise(noise, scenario)


@numba.njit(cache=True, error_model="numpy")
def _expose(
    liquid: Picture,
    light: Picture,
    chip: Picture,
    noise: Picture,
    lamp: np.float32,
    background: np.float32,
    contrast: np.float32,
    offset: np.float32,
    levels_per_electron: np.float32,
    read_variance: np.float32,
) -> None:
    """Levels with noise, written into `noise`, which holds normal deviates."""
    darkest = np.float32(_DARKEST_LEVEL)
    for row in range(liquid.shape[0]):
        for column in range(liquid.shape[1]):
            fluid = max(background + contrast * liquid[row, column], darkest)
            levels = lamp * light[row, column] * chip[row, column] * fluid
            spread = np.sqrt(levels * levels_per_electron + read_variance)
            noise[row, column] = levels + offset + spread * noise[row, column]


def _quantise(levels: Picture, scenario: Scenario) -> Grey:
    top = 2**scenario.bit_depth - 1
    levels *= np.float32(top / 255.0)
    np.rint(levels, out=levels)
    np.clip(levels, 0, top, out=levels)
    return levels.astype(np.uint8) if scenario.bit_depth == 8 else levels.astype(np.uint16)
