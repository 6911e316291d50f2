"""Single simulated frames with their truth, of seeds that nothing was trained or tuned on."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.experiment import Experiment, parse_experiment
from dropflow.parameters import Parameters, parse_parameters
from dropflow.simulation.film import Film
from dropflow.simulation.render import Renderer
from dropflow.simulation.scenario import SCENARIOS, Scenario, changed, vary

FIRST_SEED = 900_000
"""Far from those of training (`dropflow.detection.default.training`: below 20,000)."""


@dataclass(frozen=True, eq=False)
class Still:
    """One frame of a film."""

    scenario: Scenario
    frame: npt.NDArray[Any]
    flat_field: npt.NDArray[Any]
    truth: pa.Table

    def experiment(self) -> Experiment:
        """What a person would say of it."""
        about = {"name": self.scenario.name, "pixel_size_um": self.scenario.pixel_size_um, "frame_interval_s": 1.0}
        return parse_experiment(about | {"droplets": self.scenario.droplets, "material": "none"})

    def parameters(self, method: str) -> Parameters:
        """The radius range and the method."""
        low, high = self.scenario.radius_min_um, self.scenario.radius_max_um
        return parse_parameters({"detection": {"method": method, "radius_min_um": low, "radius_max_um": high}})


def still(name: str, number: int, *, is_varied: bool = False, **changes: Any) -> Still:
    """The first frame of a film of this scenario; varied ones have all constants drawn anew."""
    seed = FIRST_SEED + number
    scenario = vary(SCENARIOS[name], np.random.default_rng(seed)) if is_varied else SCENARIOS[name]
    scenario = changed(scenario, changes)
    moment = next(Film(scenario, seed).moments(1))
    renderer = Renderer(scenario, seed)
    return Still(scenario, renderer.frame(moment.cloud, 0), renderer.flat_field(), moment.truth(scenario))
