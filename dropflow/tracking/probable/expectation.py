"""Where each droplet is expected next (or was before), with the error of that."""

from dataclasses import dataclass, replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.directions import Up, unturned
from dropflow.tracking.probable.memory import Memory
from dropflow.tracking.probable.regression import WaveFlow
from dropflow.tracking.probable.ways import Ways, ways

_UNKNOWN_FLOW_SPACINGS = 0.25
"""Where nothing is known of the flow, droplets are thought to move about this part of their spacing in a step."""
_UNSTEADY_SHARE = 0.3
"""Share of the variance of what droplets do beyond flow and Stokes that is new in each step."""


@dataclass(frozen=True)
class Predicted:
    """Where droplets are expected, and how surely."""

    droplets: Droplets
    across_variance: Column
    """Of the place, across `up`, shape (n,), px^2."""
    along_variance: Column
    log_r_std: Column
    up: Up
    ways: Ways | None = None
    """That lead there; None where nothing is known of the flow."""


@dataclass(frozen=True)
class Expectation:
    """What droplets follow in a step: eq. 5 with the error of each of its parts."""

    motion: Motion
    flow: WaveFlow | None
    """None where nothing is known of it."""
    change_um_s: float
    """By how much the flow may differ from `flow`."""
    stokes_error: tuple[float, float]
    """Relative error of Stokes' velocity, and its variance."""
    noise_um_s: float
    """What single droplets do beyond flow and Stokes."""
    spacing_px: float
    widening: float
    """By which squared errors have been larger than thought."""

    def of(self, droplets: Droplets, memory: Memory, dt_s: float) -> Predicted:
        """The droplets `dt_s` later, or earlier where negative."""
        px = dt_s / self.motion.pixel_size_um
        sedimentation = self.motion.sedimentation_um_s(np.exp(memory.log_r))
        error, error_variance = self.stokes_error
        own = unturned(memory.own_across_um_s, memory.own_along_um_s, self.motion.up)
        own = own + np.outer(self.motion.up, sedimentation * (1 + error))
        way = None if self.flow is None else ways(self.flow, np.stack([droplets.x_px, droplets.y_px]), own, px)
        step_px = own * px if way is None else way.step_px
        across, along = self._variance_of_flow(way, len(droplets), px)
        noise = memory.own_variance + _UNSTEADY_SHARE * self.noise_um_s**2
        sinking = sedimentation**2 * (4 * (1 + error) ** 2 * memory.log_r_variance + error_variance)
        seen = droplets.x_std_px**2
        return Predicted(
            replace(
                droplets,
                x_px=droplets.x_px + step_px[0],
                y_px=droplets.y_px + step_px[1],
                r_px=np.exp(memory.log_r),
            ),
            np.asarray(self.widening * (across + noise * px**2 + seen)),
            np.asarray(self.widening * (along + (noise + sinking) * px**2 + seen)),
            np.sqrt(memory.log_r_variance),
            self.motion.up,
            way,
        )

    def _variance_of_flow(self, way: Ways | None, n: int, px: float) -> Column:
        """Of the displacement by it, across and along `up`, shape (2, n), px^2."""
        if self.flow is None or way is None:
            return np.full((2, n), (_UNKNOWN_FLOW_SPACINGS * self.spacing_px) ** 2)
        return np.asarray((self.flow.variance_at(*way.middle_px) + self.change_um_s**2) * px**2)
