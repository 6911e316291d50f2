"""The fluid around the simulated volume: droplets of the scenario's size distribution, uniform in space."""

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, ndtri

from dropflow.simulation.cloud import Cloud, Origin
from dropflow.simulation.optics import check_is_visible, reach_um, seen_depth_um
from dropflow.simulation.scenario import FULL_HEIGHT_PX, FULL_WIDTH_PX, Scenario

Column = npt.NDArray[np.float64]


class Reservoir:
    """Draws droplets for the simulated volume: the frame, a margin around it, and the depth in which each is lit.

    The number per volume is such that the expected number of visible droplets in a frame is the scenario's.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        pixel, margin = scenario.pixel_size_um, scenario.margin_um
        self._low_um = -0.5 * pixel - margin
        self._right_um = (scenario.width_px - 0.5) * pixel + margin
        self._bottom_um = (scenario.height_px - 0.5) * pixel + margin
        # Quantiles of the cut log-normal distribution, as equally likely radii.
        cuts = np.log(np.array([scenario.radius_min_um, scenario.radius_max_um]) / scenario.radius_median_um)
        low, high = ndtr(cuts / scenario.radius_spread)
        quantiles = low + (high - low) * (np.arange(2000) + 0.5) / 2000
        self._radii_um = scenario.radius_median_um * np.exp(scenario.radius_spread * ndtri(quantiles))
        seen_um = seen_depth_um(self._radii_um, scenario)
        check_is_visible(seen_um)
        full_area_um2 = FULL_HEIGHT_PX * FULL_WIDTH_PX * pixel**2
        self.density_per_um3 = scenario.n_droplets / (full_area_um2 * float(seen_um.mean()))
        self._nucleation_share = (self._right_um - self._low_um) * (self._bottom_um - self._low_um) / full_area_um2

    def contains(self, cloud: Cloud) -> npt.NDArray[np.bool_]:
        """Which droplets are inside the volume."""
        return self._is_lit(cloud) & self._is_beside(cloud)

    def fill(self, border_um: float, depth_um: float, rng: np.random.Generator) -> Cloud:
        """Droplets (without ids) in the volume and a shell of this width around it."""
        thickness_um = 2.0 * (reach_um(self._radii_um, self._scenario) + depth_um)
        area_um2 = (self._right_um - self._low_um + 2 * border_um) * (self._bottom_um - self._low_um + 2 * border_um)
        n = rng.poisson(self.density_per_um3 * area_um2 * float(thickness_um.mean()))
        likelihood = np.cumsum(thickness_um)
        which = np.searchsorted(likelihood, rng.uniform(0.0, likelihood[-1], n))
        return self._place(self._radii_um[which], border_um, depth_um, Origin.START, rng)

    def incoming(self, border_um: float, depth_um: float, rng: np.random.Generator) -> Cloud:
        """Droplets in the shell alone; those above or below the frame's light have origin FOCUS, others BORDER."""
        cloud = self.fill(border_um, depth_um, rng)
        cloud = cloud[~self.contains(cloud)]
        cloud.origin = np.where(self._is_beside(cloud), Origin.FOCUS, Origin.BORDER).astype(np.int8)
        return cloud

    def nucleated(self, step_s: float, rng: np.random.Generator) -> Cloud:
        """Droplets of the smallest radius, anywhere in the volume."""
        n = rng.poisson(self._scenario.nucleation_per_s * step_s * self._nucleation_share)
        return self._place(np.full(n, self._scenario.radius_min_um), 0.0, 0.0, Origin.NUCLEATION, rng)

    def _place(
        self, r_um: Column, border_um: float, depth_um: float, origin: Origin, rng: np.random.Generator
    ) -> Cloud:
        n = len(r_um)
        return Cloud(
            droplet_id=np.full(n, -1, np.int64),
            x_um=rng.uniform(self._low_um - border_um, self._right_um + border_um, n),
            y_um=rng.uniform(self._low_um - border_um, self._bottom_um + border_um, n),
            z_um=rng.uniform(-1.0, 1.0, n) * (reach_um(r_um, self._scenario) + depth_um),
            r_um=r_um,
            origin=np.full(n, origin, np.int8),
        )

    def _is_lit(self, cloud: Cloud) -> npt.NDArray[np.bool_]:
        return np.asarray(np.abs(cloud.z_um) <= reach_um(cloud.r_um, self._scenario))

    def _is_beside(self, cloud: Cloud) -> npt.NDArray[np.bool_]:
        inside_x = (cloud.x_um >= self._low_um) & (cloud.x_um <= self._right_um)
        inside_y = (cloud.y_um >= self._low_um) & (cloud.y_um <= self._bottom_um)
        return np.asarray(inside_x & inside_y)
