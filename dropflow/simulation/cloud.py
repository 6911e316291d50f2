"""Droplets in space as columns, and what can happen to them."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]


class Origin(IntEnum):
    """How a droplet came into the simulated volume."""

    START = 0
    NUCLEATION = 1
    BORDER = 2
    FOCUS = 3
    COALESCENCE = 4


@dataclass
class Cloud:
    """Droplets as columns of shape (n,), sorted by id; lengths in um, z towards the camera, 0 in the focal plane."""

    droplet_id: npt.NDArray[np.int64]
    x_um: Column
    y_um: Column
    z_um: Column
    r_um: Column
    origin: npt.NDArray[np.int8]

    def __len__(self) -> int:
        return len(self.droplet_id)

    def __getitem__(self, which: npt.NDArray[np.bool_] | npt.NDArray[np.integer]) -> "Cloud":
        return Cloud(*(column[which] for column in vars(self).values()))

    def followed_by(self, other: "Cloud") -> "Cloud":
        """Both clouds as one."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Cloud(*(np.concatenate(pair) for pair in pairs))

    def moved(self, velocity_um_s: npt.NDArray[np.float64], step_s: float) -> "Cloud":
        """The cloud after a step with a velocity of shape (3, n)."""
        x, y, z = np.array([self.x_um, self.y_um, self.z_um]) + step_s * velocity_um_s
        return Cloud(self.droplet_id, x, y, z, self.r_um, self.origin)


def no_droplets() -> Cloud:
    """A cloud of none."""
    return Cloud(np.empty(0, np.int64), np.empty(0), np.empty(0), np.empty(0), np.empty(0), np.empty(0, np.int8))


@dataclass(frozen=True)
class Coalescence:
    """Two droplets that became one, and what they became."""

    time_s: float
    parents: tuple[int, int]
    product: int
    x_um: float
    y_um: float
    z_um: float
    r_um: float
