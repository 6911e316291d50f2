"""What statistics must know of a film beside its tables."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from dropflow.experiment import Experiment
from dropflow.parameters import Parameters
from dropflow.physics.material_files import MaterialFile, find_material


@dataclass(frozen=True)
class FilmFacts:
    """What was filmed, how it was analysed, and where the results come from."""

    experiment: Experiment
    parameters: Parameters
    field_um: tuple[float, float]
    """Width and height of the frame in the sample."""
    n_frames: int
    provenance: Mapping[str, Any]
    """Goes into every table; `dropflow.figures.caption_of` makes one line of it."""

    @property
    def area_um2(self) -> float:
        """Area of the frame in the sample."""
        return self.field_um[0] * self.field_um[1]

    @property
    def extent_um(self) -> tuple[float, float]:
        """Extent of the frame across gravity and along it."""
        width_um, height_um = self.field_um
        up_x, up_y = (abs(part) for part in self.experiment.up)
        return up_y * width_um + up_x * height_um, up_x * width_um + up_y * height_um

    @cached_property
    def material_file(self) -> MaterialFile | None:
        """The named material, if the experiment names one."""
        name = self.experiment.material
        return find_material(name) if isinstance(name, str) else None

    @property
    def mixture(self) -> MaterialFile | None:
        """The material, if its numbers depend on temperature."""
        found = self.material_file
        return found if found is not None and found.mixture is not None else None

    def caption(self) -> dict[str, Any]:
        """What the line below a figure says."""
        material = self.material_file
        return {
            "experiment": self.experiment.name,
            "run": self.provenance.get("run"),
            "detection": self.parameters.detection.method,
            "tracking": self.parameters.tracking.method,
            "material": material.label if material else None,
            "dropflow": self.provenance.get("dropflow_version"),
            "input": str(self.provenance.get("input_sha256") or "")[:12],
        }
