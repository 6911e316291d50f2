"""Where a droplet will be, and was: advection by the flow plus sedimentation (eq. 5, section 3.2.1)."""

from dataclasses import dataclass, replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, FixedMaterial
from dropflow.physics.stokes import sedimentation_um_s
from dropflow.tracking.flow import FlowField
from dropflow.tracking.grid import Column

_N_ITERATIONS_BACK = 3
"""The place a droplet came from solves x = end - dt u(x); the flow changes little over a step, so three suffice."""


@dataclass(frozen=True)
class Motion:
    """How droplets of a given radius move in a given flow."""

    pixel_size_um: float
    up: tuple[float, float]
    """Unit vector against gravity in image axes."""
    material: FixedMaterial

    @staticmethod
    def of(experiment: Experiment, material: FixedMaterial) -> "Motion":
        """The motion of droplets in an experiment whose material was looked up."""
        return Motion(experiment.pixel_size_um, experiment.up, material)

    def sedimentation_um_s(self, r_px: Column) -> Column:
        """Stokes velocity along `up`, shape (n,), um/s."""
        return sedimentation_um_s(
            r_px * self.pixel_size_um,
            delta_density_kg_m3=self.material.delta_density_kg_m3,
            viscosity_pa_s=self.material.viscosity_pa_s,
        )

    def sinking_px(self, r_px: Column, dt_s: float) -> Column:
        """Displacement by sedimentation alone, shape (2, n), px."""
        along_up = self.sedimentation_um_s(r_px) * (dt_s / self.pixel_size_um)
        return np.stack([along_up * self.up[0], along_up * self.up[1]])

    def step_px(self, droplets: Droplets, flow: FlowField, dt_s: float) -> Column:
        """Displacement in `dt_s` by eq. 5 at the place where the droplets are, shape (2, n), px."""
        carried_px = flow.sample(droplets.x_px, droplets.y_px) * (dt_s / self.pixel_size_um)
        return np.asarray(carried_px + self.sinking_px(droplets.r_px, dt_s))

    def forward(self, droplets: Droplets, flow: FlowField, dt_s: float) -> Droplets:
        """The droplets as predicted `dt_s` later."""
        return moved(droplets, self.step_px(droplets, flow, dt_s))

    def backward(self, droplets: Droplets, flow: FlowField, dt_s: float) -> Droplets:
        """The droplets as they were `dt_s` before, in the flow of that step (section 3.3.2)."""
        unsunk = moved(droplets, -self.sinking_px(droplets.r_px, dt_s))
        before = unsunk
        for _ in range(_N_ITERATIONS_BACK):
            step_px = flow.sample(before.x_px, before.y_px) * (dt_s / self.pixel_size_um)
            before = moved(unsunk, -step_px)
        return before

    def advection_um_s(self, before: Droplets, after: Droplets, dt_s: float) -> Column:
        """Velocity of the fluid that carried each droplet, shape (2, n): its own minus its sedimentation.

        The radius is the mean of both ends, whose error is smaller than that of either.
        """
        moved_px = np.stack([after.x_px - before.x_px, after.y_px - before.y_px])
        sunk_px = self.sinking_px((before.r_px + after.r_px) / 2, dt_s)
        return np.asarray((moved_px - sunk_px) * (self.pixel_size_um / dt_s))


def moved(droplets: Droplets, by_px: Column) -> Droplets:
    """The droplets displaced by `by_px`, shape (2, n)."""
    return replace(droplets, x_px=droplets.x_px + by_px[0], y_px=droplets.y_px + by_px[1])
