"""Density difference and viscosity frame by frame: along a temperature ramp they change."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import Experiment, FixedMaterial, Phase
from dropflow.physics.material import MixtureProperties, resolve
from dropflow.physics.material_files import find_material

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class MaterialOverTime:
    """What Stokes' law needs in each frame, each of shape (n_frames,)."""

    delta_density_kg_m3: Floats
    viscosity_pa_s: Floats

    def at(self, frame: int) -> FixedMaterial:
        """The values in one frame."""
        return FixedMaterial(
            delta_density_kg_m3=float(self.delta_density_kg_m3[frame]), viscosity_pa_s=float(self.viscosity_pa_s[frame])
        )

    @property
    def mean(self) -> FixedMaterial:
        """Means over the frames."""
        return FixedMaterial(
            delta_density_kg_m3=float(self.delta_density_kg_m3.mean()), viscosity_pa_s=float(self.viscosity_pa_s.mean())
        )

    @property
    def density_over_viscosity_s_m2(self) -> Floats:
        """Density difference over viscosity, which decides how fast droplets sediment, s/m2."""
        return np.asarray(self.delta_density_kg_m3 / self.viscosity_pa_s)

    @property
    def is_constant(self) -> bool:
        """Whether it is the same in all frames."""
        values = np.stack([self.delta_density_kg_m3, self.viscosity_pa_s])
        return bool((values == values[:, :1]).all())

    @property
    def checksum(self) -> str:
        """SHA-256 of all values."""
        return hashlib.sha256(self.delta_density_kg_m3.tobytes() + self.viscosity_pa_s.tobytes()).hexdigest()


def material_over_time(
    experiment: Experiment, n_frames: int, temperature_c: Sequence[float] | Floats | None = None
) -> MaterialOverTime:
    """The material of an experiment in each frame.

    Parameters
    ----------
    experiment
        Its `material` may be two numbers or the name of a material file; one whose numbers depend on temperature
        needs `phase` as well.
    n_frames
        Frames of the film.
    temperature_c
        Temperature in each frame, shape (n_frames,), from the experiment's temperature log.

    Raises
    ------
    ExperimentError
        Field ``material``: unknown. Field ``temperature_log`` or ``phase``: needed by this material and not given.
        Field ``temperature_log``: a temperature at which the material does not demix.
    """
    name = experiment.material
    material = find_material(name) if isinstance(name, str) else None
    if material is None or material.mixture is None:
        fixed = resolve(experiment)
        return MaterialOverTime(np.full(n_frames, fixed.delta_density_kg_m3), np.full(n_frames, fixed.viscosity_pa_s))
    _check_known(experiment, material.name, has_temperature=temperature_c is not None)
    at_c = np.asarray(temperature_c, np.float64)
    properties = MixtureProperties(material)
    _check_demixed(at_c, properties.binodal.range_c)
    bottom, top = properties.binodal.phases(at_c)
    fluid, droplet = (bottom, top) if experiment.phase is Phase.BOTTOM else (top, bottom)
    density = properties.density_kg_m3
    return MaterialOverTime(density(droplet, at_c) - density(fluid, at_c), properties.viscosity_pa_s(fluid, at_c))


def check_material(experiment: Experiment) -> None:
    """Raise the errors of `material_over_time` that can be told before there is a film."""
    name = experiment.material
    material = find_material(name) if isinstance(name, str) else None
    if material is not None and material.mixture is not None:
        _check_known(experiment, material.name, has_temperature=experiment.temperature_log is not None)


def _check_known(experiment: Experiment, name: str, *, has_temperature: bool) -> None:
    problems = []
    if not has_temperature:
        problems.append(FieldProblem("temperature_log", f"is needed: {name} has other values at each temperature"))
    if experiment.phase is None:
        problems.append(FieldProblem("phase", f"is needed: the phases of {name} differ in density and viscosity"))
    if problems:
        raise ExperimentError(
            "The temperature of the film and the phase must be known.",
            code="experiment.material_needs_temperature",
            fields=problems,
            hint="Give temperature_log (CSV with time_s, temperature_c) and phase; or two numbers: "
            f"`dropflow material {name} --temperature-c T` prints them for a film at one temperature.",
        )


def _check_demixed(temperature_c: Floats, range_c: tuple[float, float]) -> None:
    low, high = range_c
    outside = (temperature_c < low) | (temperature_c > high)
    if outside.any():
        frame = int(np.argmax(outside))
        raise ExperimentError(
            "The temperature leaves the range of the material.",
            code="material.temperature_outside",
            frame=frame,
            fields=[
                FieldProblem(
                    "temperature_log",
                    f"{temperature_c[frame]:.4g} °C in frame {frame}, but the material is known from {low:g} to "
                    f"{high:g} °C",
                )
            ],
            hint="Leave out the frames before the fluids demix, or give the material as two numbers.",
        )
