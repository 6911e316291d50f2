"""Waves of nucleation: the oscillating experiment of sections 4.5 to 4.7, with everything known about it.

Each wave brings droplets of one age. They grow together, thin out as the next wave comes, and the flow beats with
them. A film of it is made of clouds, so that it can be written as tables alone or with images.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.special import ndtri

from dropflow.physics.stokes import sedimentation_um_s
from dropflow.progress import Progress, silent
from dropflow.simulation.cloud import Cloud, Origin
from dropflow.simulation.film import Film
from dropflow.simulation.flow import RandomFlow
from dropflow.simulation.optics import reach_um, seen_depth_um
from dropflow.simulation.population import UP
from dropflow.simulation.scenario import FULL_HEIGHT_PX, FULL_WIDTH_PX, Scenario
from dropflow.simulation.write import render_positions

Column = npt.NDArray[np.float64]

_N_QUANTILES = 400


@dataclass(frozen=True)
class Waves:
    """When waves of nucleation come and what they bring."""

    n_waves: int = 4
    """Waves that begin within the film."""
    period_s: float = 60.0
    """Time from the first wave to the second."""
    period_ratio: float = 0.92
    """Each period over the one before: they shorten as the sample warms (section 4.7)."""
    first_radius_um: float = 5.0
    """Median radius at nucleation."""
    growth_um_s: float = 0.2
    """Growth of the median radius."""
    spread: float = 0.18
    """Standard deviation of ln(r) within a wave; it stays, so a droplet grows in proportion to its radius."""
    rise_share: float = 0.15
    """Share of the period in which a wave nucleates."""
    lifetime_share: float = 0.45
    """Mean life of a wave's droplets after that, in periods."""
    flow_swing: float = 0.5
    """Relative swing of the flow with the waves."""
    drift_swing: float = 0.8
    """Relative swing of the mean flow."""

    @property
    def starts_s(self) -> Column:
        """When each wave begins: one before the film, so that it does not begin empty, and one after the last."""
        periods = self.period_s * self.period_ratio ** np.arange(-1.0, self.n_waves)
        return np.asarray(np.concatenate([[0.0], np.cumsum(periods)]) - periods[0])

    @property
    def duration_s(self) -> float:
        """When the last wave of the film ends."""
        return float(self.starts_s[-1])

    def phase(self, time_s: float) -> float:
        """Share of the present wave's period that has passed, 0 to 1."""
        starts = self.starts_s
        number = int(np.clip(np.searchsorted(starts, time_s, side="right") - 1, 0, len(starts) - 2))
        return float((time_s - starts[number]) / (starts[number + 1] - starts[number]))

    def median_um(self, wave: int, time_s: float) -> float:
        """Median radius of a wave."""
        return self.first_radius_um + self.growth_um_s * max(time_s - float(self.starts_s[wave]), 0.0)

    def strength(self, wave: int, time_s: float) -> float:
        """Droplets per volume over what a wave has at its peak, about."""
        age_s = time_s - float(self.starts_s[wave])
        if age_s <= 0:
            return 0.0
        period_s = float(np.diff(self.starts_s)[min(wave, len(self.starts_s) - 2)])
        born = min(age_s / (self.rise_share * period_s), 1.0)
        return float(born * np.exp(-max(age_s / period_s - self.rise_share, 0.0) / self.lifetime_share))

    def swing(self, time_s: float, amplitude: float) -> float:
        """Factor of the flow: largest in the middle of a wave, when its droplets are large and still many."""
        return 1.0 - amplitude * float(np.cos(2 * np.pi * self.phase(time_s)))


DEFAULT_WAVES = Waves()
OSCILLATING = Scenario(
    name="oscillating",
    n_droplets=600,
    delta_density_kg_m3=-25.0,
    flow_rms_um_s=6.0,
    flow_depth_rms_um_s=1.5,
    drift_y_um_s=3.0,
    growth_um_s=0.0,
    nucleation_per_s=0.0,
    collision_efficiency=0.0,
)
"""Optics and flow; size distribution, growth and nucleation are those of the waves."""


@dataclass(frozen=True)
class WaveFlow:
    """The random flow of a scenario, beating with the waves; it stays free of divergence."""

    flow: RandomFlow
    waves: Waves

    def velocity_um_s(self, x_um: Column, y_um: Column, time_s: float) -> npt.NDArray[np.float64]:
        """Velocity at points (n,): shape (3, n)."""
        drift = np.array([[self.flow.drift_x_um_s], [self.flow.drift_y_um_s], [0.0]])
        random = self.flow.velocity_um_s(x_um, y_um, time_s) - drift
        waves = self.waves
        return np.asarray(
            random * waves.swing(time_s, waves.flow_swing) + drift * waves.swing(time_s, waves.drift_swing)
        )


class WavePopulation:
    """The droplets in a box around the frame, open to a fluid of the same waves on all sides."""

    def __init__(self, scenario: Scenario, waves: Waves, flow: WaveFlow, rng: np.random.Generator) -> None:
        self._scenario, self._waves, self._flow, self._rng = scenario, waves, flow, rng
        pixel, margin = scenario.pixel_size_um, scenario.margin_um
        depth = float(reach_um(np.array([scenario.radius_max_um]), scenario)[0])
        self._low = np.array([-margin, -margin, -depth])
        self._high = np.array([scenario.width_px * pixel + margin, scenario.height_px * pixel + margin, depth])
        self._quantiles = np.exp(waves.spread * ndtri((np.arange(_N_QUANTILES) + 0.5) / _N_QUANTILES))
        seen_um = seen_depth_um(waves.median_um(1, waves.starts_s[2]) * self._quantiles, scenario)
        self._density_per_um3 = scenario.n_droplets / (FULL_HEIGHT_PX * FULL_WIDTH_PX * pixel**2 * seen_um.mean())
        self._next_id = 0
        self.time_s = 0.0
        self._place = np.empty((3, 0))
        self._id, self._wave, self._factor = np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
        for wave in range(len(waves.starts_s)):
            self._bring(wave, waves.strength(wave, 0.0), np.zeros(3))

    @property
    def cloud(self) -> Cloud:
        """All droplets, sorted by id."""
        x, y, z = self._place
        origin = np.full(len(self._id), Origin.START, np.int8)
        cloud = Cloud(self._id, x, y, z, self._radius_um(), origin)
        return cloud[np.argsort(self._id)]

    def advance(self, interval_s: float) -> None:
        """Move, grow, die, nucleate, and exchange with the fluid around."""
        largest = float(np.max(self._radius_um(), initial=self._scenario.radius_min_um))
        fastest = abs(float(self._rise_um_s(np.array([largest]))[0])) + 6 * self._scenario.flow_rms_um_s
        n_steps = max(1, int(np.ceil(fastest * interval_s / self._scenario.max_step_um)))
        for _ in range(n_steps):
            self._step(interval_s / n_steps)

    def _radius_um(self) -> Column:
        medians = np.array([self._waves.median_um(wave, self.time_s) for wave in range(len(self._waves.starts_s))])
        return np.asarray(medians[self._wave] * self._factor)

    def _rise_um_s(self, r_um: Column) -> Column:
        scenario = self._scenario
        return sedimentation_um_s(
            r_um, delta_density_kg_m3=scenario.delta_density_kg_m3, viscosity_pa_s=scenario.viscosity_pa_s
        )

    def _velocity(self, place: npt.NDArray[np.float64], rise: Column, time_s: float) -> npt.NDArray[np.float64]:
        velocity = self._flow.velocity_um_s(place[0], place[1], time_s)
        return np.asarray(velocity + np.array([rise * UP[0], rise * UP[1], np.zeros_like(rise)]))

    def _step(self, step_s: float) -> None:
        waves = self._waves
        # A shell of fluid comes along, as full as the volume; what then is inside is the new population.
        shell = np.array([1.5, 1.5, 0.0]) * self._scenario.max_step_um
        shell[2] = 5 * self._scenario.flow_depth_rms_um_s * step_s * (1 + waves.flow_swing)
        for wave in range(len(waves.starts_s)):
            self._bring(wave, waves.strength(wave, self.time_s), shell)
        rise = self._rise_um_s(self._radius_um())
        middle = self._place + 0.5 * step_s * self._velocity(self._place, rise, self.time_s)
        self._place = self._place + step_s * self._velocity(middle, rise, self.time_s + 0.5 * step_s)
        before = [waves.strength(wave, self.time_s) for wave in range(len(waves.starts_s))]
        self.time_s += step_s
        after = [waves.strength(wave, self.time_s) for wave in range(len(waves.starts_s))]
        with np.errstate(invalid="ignore", divide="ignore"):
            stays = np.where(np.array(before) > 0, np.minimum(np.array(after) / np.array(before), 1.0), 1.0)
        is_inside = ((self._place >= self._low[:, None]) & (self._place <= self._high[:, None])).all(axis=0)
        self._keep(is_inside & (self._rng.uniform(size=len(self._id)) < stays[self._wave]))
        for wave, (old, new) in enumerate(zip(before, after, strict=True)):
            self._bring(wave, max(new - old, 0.0), np.zeros(3))

    def _keep(self, which: npt.NDArray[np.bool_]) -> None:
        self._place, self._id = self._place[:, which], self._id[which]
        self._wave, self._factor = self._wave[which], self._factor[which]

    def _bring(self, wave: int, strength: float, shell: npt.NDArray[np.float64]) -> None:
        """New droplets of a wave, uniform in the volume, or in the shell around it alone where there is one."""
        low, high = self._low - shell, self._high + shell
        n = int(self._rng.poisson(self._density_per_um3 * strength * np.prod(high - low)))
        place = self._rng.uniform(low[:, None], high[:, None], (3, n))
        if shell.any():
            place = place[:, ((place < self._low[:, None]) | (place > self._high[:, None])).any(axis=0)]
        n = place.shape[1]
        self._place = np.concatenate([self._place, place], axis=1)
        self._id = np.concatenate([self._id, self._next_id + np.arange(n)])
        self._wave = np.concatenate([self._wave, np.full(n, wave, np.int64)])
        self._factor = np.concatenate([self._factor, self._rng.choice(self._quantiles, n)])
        self._next_id += n


def wave_flow(scenario: Scenario, waves: Waves, seed: int) -> WaveFlow:
    """The flow of an oscillating film."""
    return WaveFlow(Film(scenario, seed).flow, waves)


def wave_clouds(scenario: Scenario, waves: Waves, n_frames: int, seed: int) -> Iterator[Cloud]:
    """The droplets of each frame."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x05]))
    population = WavePopulation(scenario, waves, wave_flow(scenario, waves, seed), rng)
    for frame in range(n_frames):
        if frame:
            population.advance(scenario.frame_interval_s)
        yield population.cloud


def write_oscillating(
    out: Path,
    *,
    scenario: Scenario = OSCILLATING,
    waves: Waves = DEFAULT_WAVES,
    n_frames: int | None = None,
    seed: int = 0,
    with_images: bool = True,
    progress: Progress = silent,
) -> None:
    """Write a film of nucleation waves as `dropflow.simulation.write.write_experiment` does.

    Without `n_frames` it lasts until the last wave has passed.
    """
    flow = wave_flow(scenario, waves, seed)
    grid, pixel = scenario.grid, scenario.pixel_size_um

    def flow_at(time_s: float) -> npt.NDArray[np.float64]:
        x_um, y_um = np.meshgrid(grid.x_px * pixel, grid.y_px * pixel)
        velocity = flow.velocity_um_s(x_um.ravel(), y_um.ravel(), time_s)
        return np.asarray(velocity[:2].reshape(2, grid.n_rows, grid.n_columns))

    n = n_frames if n_frames is not None else int(waves.duration_s / scenario.frame_interval_s)
    clouds = wave_clouds(scenario, waves, n, seed)
    render_positions(out, scenario, clouds, n, seed=seed, flow_at=flow_at, with_images=with_images, progress=progress)
