"""A simulated film as a stream: droplets, their motion and what happened, frame by frame. Memory does not grow."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.physics.stokes import sedimentation_um_s
from dropflow.simulation.cloud import Cloud, Coalescence
from dropflow.simulation.flow import RandomFlow, random_flow
from dropflow.simulation.population import UP, Population
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.truth import Motion, truth_table


@dataclass(frozen=True)
class Moment:
    """One frame: the droplets in the volume, and their motion to the next frame."""

    frame: int
    time_s: float
    cloud: Cloud
    motion: Motion
    coalescences: tuple[Coalescence, ...] = field(default=())
    """Those since the frame before."""

    def truth(self, scenario: Scenario) -> pa.Table:
        """Rows of `dropflow.simulation.truth.TRUTH`."""
        return truth_table(self.cloud, self.motion, scenario, frame=self.frame, time_s=self.time_s)


@dataclass(frozen=True)
class Film:
    """A scenario with its seed: everything in it follows from the two."""

    scenario: Scenario
    seed: int

    @property
    def flow(self) -> RandomFlow:
        """The flow, at any place and time."""
        return random_flow(self.scenario, np.random.default_rng(np.random.SeedSequence([self.seed, 0xF1])))

    def moments(self, n_frames: int) -> Iterator[Moment]:
        """The first `n_frames` frames, in order."""
        interval_s = self.scenario.frame_interval_s
        rng = np.random.default_rng(np.random.SeedSequence([self.seed, 0xC1]))
        population = Population(self.scenario, self.flow, rng)
        events: list[Coalescence] = []
        for frame in range(n_frames):
            time_s = population.time_s = frame * interval_s
            cloud = population.cloud
            velocity, flow = population.velocity_um_s(cloud, time_s)
            happened, events = tuple(events), []
            if frame + 1 < n_frames:
                carried, events = population.advance(interval_s)
                reaches = np.isfinite(carried[0])
                flow[:2, reaches] = carried[:, reaches]
                velocity[:2, reaches] = _displacement(cloud, population.cloud, reaches) / interval_s
            rise = population.rise_um_s(cloud.r_um)
            motion = Motion(velocity[0], velocity[1], rise, flow[0], flow[1])
            yield Moment(frame, time_s, cloud, motion, happened)


def moments_of_paths(clouds: Iterable[Cloud], scenario: Scenario) -> Iterator[Moment]:
    """Moments of droplets on given paths, one cloud a frame, each sorted by id; it looks one frame ahead."""
    before: Cloud | None = None
    here: Cloud | None = None
    frame = 0
    for after in clouds:
        if here is not None:
            yield _moment_of_path(frame, before, here, after, scenario)
            before, frame = here, frame + 1
        here = after
    if here is not None:
        yield _moment_of_path(frame, before, here, None, scenario)


def _moment_of_path(frame: int, before: Cloud | None, here: Cloud, after: Cloud | None, scenario: Scenario) -> Moment:
    interval_s = scenario.frame_interval_s
    rise = sedimentation_um_s(
        here.r_um, delta_density_kg_m3=scenario.delta_density_kg_m3, viscosity_pa_s=scenario.viscosity_pa_s
    )
    sinking = np.array([rise * UP[0], rise * UP[1]])
    velocity = sinking.copy()
    for one, other in ((before, here), (here, after)):
        if one is None or other is None:
            continue
        reaches = np.isin(one.droplet_id, other.droplet_id)
        moved = one.droplet_id[reaches]
        velocity[:, np.searchsorted(here.droplet_id, moved)] = _displacement(one, other, reaches) / interval_s
    flow = velocity - sinking
    return Moment(frame, frame * interval_s, here, Motion(velocity[0], velocity[1], rise, flow[0], flow[1]))


def _displacement(before: Cloud, after: Cloud, reaches: npt.NDArray[np.bool_]) -> npt.NDArray[np.float64]:
    there = np.searchsorted(after.droplet_id, before.droplet_id[reaches])
    return np.array([after.x_um[there] - before.x_um[reaches], after.y_um[there] - before.y_um[reaches]])
