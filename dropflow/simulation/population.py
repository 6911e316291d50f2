"""The droplets in a volume around the frame, and what happens to them between two frames.

The volume is open: at each sub-step a shell around it is filled anew with droplets of the original distribution, and
those that the flow and gravity carry in stay. So the density is right at every border, whatever the velocities.
"""

import numpy as np
import numpy.typing as npt

from dropflow.physics.stokes import sedimentation_um_s
from dropflow.simulation.cloud import Cloud, Coalescence, no_droplets
from dropflow.simulation.coalescence import coalesce, without_early_merges
from dropflow.simulation.flow import RandomFlow
from dropflow.simulation.reservoir import Reservoir
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.wakes import wake_um_s

Column = npt.NDArray[np.float64]
Velocity = npt.NDArray[np.float64]

UP = (0.0, -1.0)
"""Gravity points down the image in simulated films."""
_SMALLEST_SHARE = 0.25
"""Droplets that shrink stop at this share of the smallest radius."""


class Population:
    """All droplets in the volume at a time; `advance` moves them on."""

    def __init__(self, scenario: Scenario, flow: RandomFlow, rng: np.random.Generator) -> None:
        self._scenario, self._flow, self._rng = scenario, flow, rng
        self._reservoir = Reservoir(scenario)
        self._next_id = 0
        self.time_s = 0.0
        self.cloud = no_droplets()
        self._add(self._reservoir.fill(0.0, 0.0, rng))

    def rise_um_s(self, r_um: Column) -> Column:
        """Stokes velocity along up."""
        return sedimentation_um_s(
            r_um,
            delta_density_kg_m3=self._scenario.delta_density_kg_m3,
            viscosity_pa_s=self._scenario.viscosity_pa_s,
        )

    def velocity_um_s(self, cloud: Cloud, time_s: float) -> tuple[Velocity, Velocity]:
        """Velocity of each droplet, and that of the flow at its place: both of shape (3, n)."""
        flow = self._flow.velocity_um_s(cloud.x_um, cloud.y_um, time_s)
        rise = self.rise_um_s(cloud.r_um)
        velocity = flow + np.array([rise * UP[0], rise * UP[1], np.zeros_like(rise)])
        if self._scenario.wake_strength > 0:
            velocity += wake_um_s(
                cloud, rise, UP, strength=self._scenario.wake_strength, range_um=self._scenario.wake_range_um
            )
        return velocity, flow

    def advance(self, interval_s: float) -> tuple[Velocity, list[Coalescence]]:
        """Move on by `interval_s`.

        Returns, for each droplet that was there before, the mean velocity of the flow along its way (shape (2, n),
        NaN where it is not there any more), and the coalescences in order of time.
        """
        n_steps = self._n_steps(interval_s)
        before = self.cloud.droplet_id
        carried = np.zeros((2, len(before)))
        events: list[Coalescence] = []
        for _ in range(n_steps):
            flow = self._move(interval_s / n_steps)
            there, where = self._find(before)
            carried[:, there] += flow[:2, where] / n_steps
            self._exchange(interval_s / n_steps)
            events += self._coalesce()
            carried[:, ~self._find(before)[0]] = np.nan
        return carried, events

    def _find(self, ids: npt.NDArray[np.int64]) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.int64]]:
        """Which of these droplets are there, and the index of each that is."""
        there = np.isin(ids, self.cloud.droplet_id, assume_unique=True)
        return there, np.searchsorted(self.cloud.droplet_id, ids[there])

    def _n_steps(self, interval_s: float) -> int:
        """Sub-steps in which not even the fastest droplet moves farther than the scenario allows."""
        scenario = self._scenario
        largest = np.maximum(self.cloud.r_um.max(initial=0.0), scenario.radius_max_um)
        drift = float(np.hypot(scenario.drift_x_um_s, scenario.drift_y_um_s))
        fastest = abs(float(self.rise_um_s(largest))) + drift + 4.0 * scenario.flow_rms_um_s
        return max(1, int(np.ceil(fastest * interval_s / scenario.max_step_um)))

    def _move(self, step_s: float) -> Velocity:
        """Motion by the midpoint rule, and growth; returns the flow at the midpoints."""
        scenario, cloud = self._scenario, self.cloud
        first, _ = self.velocity_um_s(cloud, self.time_s)
        velocity, flow = self.velocity_um_s(cloud.moved(first, 0.5 * step_s), self.time_s + 0.5 * step_s)
        self.cloud = cloud.moved(velocity, step_s)
        growth = scenario.growth_um_s * (cloud.r_um / 10.0) ** scenario.growth_exponent
        self.cloud.r_um = np.maximum(cloud.r_um + step_s * growth, _SMALLEST_SHARE * scenario.radius_min_um)
        self.time_s += step_s
        return flow

    def _exchange(self, step_s: float) -> None:
        """Droplets leave and come in over the borders and in depth, and new ones nucleate."""
        scenario = self._scenario
        self.cloud = self.cloud[self._reservoir.contains(self.cloud)]
        shell = self._reservoir.incoming(
            1.5 * scenario.max_step_um, 5.0 * scenario.flow_depth_rms_um_s * step_s, self._rng
        )
        rise = self.rise_um_s(shell.r_um)
        velocity = self._flow.velocity_um_s(shell.x_um, shell.y_um, self.time_s)
        velocity += np.array([rise * UP[0], rise * UP[1], np.zeros_like(rise)])
        shell = shell.moved(velocity, step_s)
        coming = shell[self._reservoir.contains(shell)]
        self._add(coming.followed_by(self._reservoir.nucleated(step_s, self._rng)))

    def _add(self, new: Cloud) -> None:
        n_old = len(self.cloud)
        new.droplet_id = self._next_id + np.arange(len(new))
        self._next_id += len(new)
        self.cloud = without_early_merges(self.cloud.followed_by(new), n_old, self._scenario.collision_efficiency)

    def _coalesce(self) -> list[Coalescence]:
        self.cloud, events = coalesce(
            self.cloud,
            efficiency=self._scenario.collision_efficiency,
            time_s=self.time_s,
            next_id=self._next_id,
        )
        self._next_id += len(events)
        return events
