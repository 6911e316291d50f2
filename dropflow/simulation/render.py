"""From droplets in space to the picture that the camera takes."""

import numba
import numpy as np
import numpy.typing as npt

from dropflow.simulation.camera import Grey, chip_transmission, exposed, flat_field, gradient_light
from dropflow.simulation.cloud import Cloud
from dropflow.simulation.optics import BLUR_REACH, SAMPLES_PER_PX, blur_px, blurred_profile
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.streaks import streaks, upstream_streaks

Column = npt.NDArray[np.float64]
Picture = npt.NDArray[np.float32]

_CHIP, _FLAT_FIELD, _NOISE, _STREAKS = range(4)


class Renderer:
    """Takes the frames of one film: the same seed and the same droplets give the same pixels, in any order."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self._scenario, self._seed = scenario, seed
        self._chip = chip_transmission(scenario, self._rng(_CHIP))
        self._gradient = gradient_light(np.arange(scenario.height_px), scenario).astype(np.float32)

    def flat_field(self) -> Grey:
        """The picture of the empty chip."""
        return flat_field(self._scenario, self._chip, self._rng(_FLAT_FIELD))

    def frame(self, cloud: Cloud, frame: int) -> Grey:
        """The picture of `cloud` as frame number `frame`: shape (height, width), uint8 or uint16."""
        scenario = self._scenario
        upstream = upstream_streaks(scenario, frame * scenario.frame_interval_s, self._seed)
        light = (1.0 + streaks(cloud, upstream, scenario)) * self._gradient[:, None]
        np.maximum(light, np.float32(0.02), out=light)
        return exposed(liquid(cloud, scenario), light, self._chip, scenario, self._rng(_NOISE, frame))

    def _rng(self, *what: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence([self._seed, *what]))


def liquid(cloud: Cloud, scenario: Scenario) -> Picture:
    """Share of the sheet's depth that is droplet liquid seen by the camera, shape (height, width), float32.

    Droplets are drawn from near to far: each adds its light times what the nearer ones let through.
    """
    pixel = scenario.pixel_size_um
    near_to_far = cloud[np.argsort(-cloud.z_um, kind="stable")]
    shape = (scenario.height_px, scenario.width_px)
    seen, passed = np.zeros(shape, np.float32), np.ones(shape, np.float32)
    _draw(
        seen,
        passed,
        near_to_far.x_um / pixel,
        near_to_far.y_um / pixel,
        near_to_far.z_um,
        near_to_far.r_um,
        blur_px(near_to_far.z_um, scenario),
        scenario.sheet_sigma_um,
        pixel,
        scenario.opacity,
        scenario.opacity_depth_um,
    )
    return seen


@numba.njit(cache=True, error_model="numpy")
def _draw(
    seen: Picture,
    passed: Picture,
    x: Column,
    y: Column,
    z_um: Column,
    r_um: Column,
    blur: Column,
    sheet_um: float,
    pixel_um: float,
    opacity: float,
    opacity_depth_um: float,
) -> None:
    height, width = seen.shape
    for i in range(x.size):
        reach = r_um[i] / pixel_um + BLUR_REACH * blur[i]
        left, right = max(int(np.ceil(x[i] - reach)), 0), min(int(np.floor(x[i] + reach)), width - 1)
        top, bottom = max(int(np.ceil(y[i] - reach)), 0), min(int(np.floor(y[i] + reach)), height - 1)
        if left > right or top > bottom:
            continue
        light, opaque = blurred_profile(r_um[i], z_um[i], blur[i], sheet_um, pixel_um, opacity, opacity_depth_um)
        for row in range(top, bottom + 1):
            dy2 = (row - y[i]) ** 2
            for column in range(left, right + 1):
                place = np.sqrt((column - x[i]) ** 2 + dy2) * SAMPLES_PER_PX
                k = int(place)
                if k + 1 >= light.size:
                    continue
                part = place - k
                seen[row, column] += passed[row, column] * (light[k] + part * (light[k + 1] - light[k]))
                passed[row, column] *= max(1.0 - (opaque[k] + part * (opaque[k + 1] - opaque[k])), 0.0)
