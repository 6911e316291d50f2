"""One still with its truth: what the model is trained on, and judged by."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.experiment import DropletTone
from dropflow.simulation.truth import Visibility

Column = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scene:
    """A frame as a camera gives it, and the droplets in it."""

    family: str
    frame: npt.NDArray[np.generic]
    flat_field: npt.NDArray[np.generic] | None
    tone: DropletTone
    r_min_px: float
    r_max_px: float
    x_px: Column
    y_px: Column
    r_px: Column
    visibility: npt.NDArray[np.str_]
    """`dropflow.simulation.truth.Visibility` of each droplet."""
    edge_px: Column
    """Radius at which each droplet's brightness falls fastest."""

    @property
    def is_visible(self) -> npt.NDArray[np.bool_]:
        """Droplets that ought to be found."""
        return np.asarray(self.visibility == Visibility.VISIBLE.value)

    @property
    def is_not_visible(self) -> npt.NDArray[np.bool_]:
        """Droplets that ought not to be found."""
        return np.asarray(self.visibility == Visibility.NOT.value)
