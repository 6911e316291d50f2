"""What is known of each droplet that is followed, beyond its place: its size and its own ways."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices

_GROWTH_PER_S = 0.01
"""Standard deviation of the change of ln r in a second, by growth."""
_LEAST_LOG_R_STD = 0.01
_KEPT_PER_STEP = 0.9
"""Share of a droplet's own deviation from flow and Stokes that is still there in the next step."""


@dataclass(frozen=True)
class Memory:
    """Each attribute of shape (n,), in the order of the front it belongs to."""

    log_r: Column
    """ln of the radius, px, averaged over the trajectory so far."""
    log_r_variance: Column
    own_across_um_s: Column
    """The droplet's velocity beyond flow and Stokes, across `up`."""
    own_along_um_s: Column
    own_variance: Column
    """Of either component, (um/s)^2."""
    evidence: Column
    """How much more probable (ln) than chance the trajectory is so far."""
    n_undetected: Indices
    """Frames since it was last detected."""
    n_unseen: Indices
    """Frames since it was last seen at all."""

    def __getitem__(self, which: npt.NDArray[np.bool_] | Indices) -> "Memory":
        return Memory(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @staticmethod
    def of_new(r_px: Column, r_std_px: Column, own_variance: float) -> "Memory":
        """Droplets seen for the first time; `own_variance` is what is usual."""
        n, none = len(r_px), np.zeros(len(r_px))
        log_r_std = np.maximum(r_std_px / r_px, _LEAST_LOG_R_STD)
        own = np.full(n, own_variance)
        never = np.zeros(n, np.int64)
        return Memory(np.log(r_px), log_r_std**2, none, none, own, none, never, never)

    @staticmethod
    def concatenate(parts: "list[Memory]") -> "Memory":
        """All of `parts`, in order."""
        return Memory(
            *(np.concatenate([getattr(part, name) for part in parts]) for name in Memory.__dataclass_fields__)
        )

    def aged(self, dt_s: float, own_variance: float) -> "Memory":
        """The same droplets `dt_s` later, before they are looked at."""
        kept = _KEPT_PER_STEP
        return replace(
            self,
            log_r_variance=self.log_r_variance + (_GROWTH_PER_S * dt_s) ** 2,
            own_across_um_s=kept * self.own_across_um_s,
            own_along_um_s=kept * self.own_along_um_s,
            own_variance=kept**2 * self.own_variance + (1 - kept**2) * own_variance,
        )

    def measured(self, r_px: Column, r_std_px: Column) -> "Memory":
        """With the radius seen once more."""
        seen_variance = np.maximum(r_std_px / r_px, _LEAST_LOG_R_STD) ** 2
        gain = self.log_r_variance / (self.log_r_variance + seen_variance)
        log_r = self.log_r + gain * (np.log(r_px) - self.log_r)
        return replace(self, log_r=np.asarray(log_r), log_r_variance=np.asarray((1 - gain) * self.log_r_variance))

    def moved(self, across_um_s: Column, along_um_s: Column, variance: Column) -> "Memory":
        """With its velocity beyond flow and Stokes seen once more, with this error."""
        gain = self.own_variance / (self.own_variance + variance)
        return replace(
            self,
            own_across_um_s=np.asarray(self.own_across_um_s + gain * (across_um_s - self.own_across_um_s)),
            own_along_um_s=np.asarray(self.own_along_um_s + gain * (along_um_s - self.own_along_um_s)),
            own_variance=np.asarray((1 - gain) * self.own_variance),
        )
