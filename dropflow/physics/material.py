"""From what an experiment says of its fluids to the numbers that Stokes' law needs."""

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import Experiment, FixedMaterial, Phase
from dropflow.physics.binodal import Binodal
from dropflow.physics.density import ExpandingDensity, WaterDensity, mixture_density_kg_m3
from dropflow.physics.material_files import Fluid, MaterialFile, Mixture, find_material
from dropflow.physics.viscosity import mixture_viscosity_pa_s

Floats = npt.NDArray[np.float64]
Value = TypeVar("Value")


def resolve(experiment: Experiment) -> FixedMaterial:
    """Density difference (kg/m3, droplet minus fluid) and viscosity (Pa s) of an experiment.

    Fixed values pass through, a name is looked up among the material files.

    Raises
    ------
    ExperimentError
        Field ``material``: no material has this name, or its numbers depend on temperature. Nothing is ever assumed.
    """
    if isinstance(experiment.material, FixedMaterial):
        return experiment.material
    material = find_material(experiment.material)
    if material.fixed is None:
        problem = FieldProblem("material", f"{material.name} has other values at each temperature")
        raise ExperimentError(
            "The temperature of the film must be known.",
            code="experiment.material_needs_temperature",
            fields=[problem],
            hint=f"`dropflow material {material.name} --temperature-c T` prints delta_density_kg_m3 and viscosity_pa_s "
            "at the temperature of the film: give these.",
        )
    return _without_source(material.fixed)


def resolve_at(material: MaterialFile, *, temperature_c: float, phase: Phase) -> FixedMaterial:
    """Density difference and viscosity of droplets of one phase in the other at a temperature.

    In the bottom phase droplets have the composition of the top phase, and the other way round.

    Raises
    ------
    ExperimentError
        The material lacks a property that is needed, or the temperature is outside its range.
    """
    if material.fixed is not None:
        return _without_source(material.fixed)
    properties = MixtureProperties(material)
    bottom, top = properties.binodal.phases(temperature_c)
    fluid, droplet = (bottom, top) if phase is Phase.BOTTOM else (top, bottom)
    density = properties.density_kg_m3
    return FixedMaterial(
        delta_density_kg_m3=float(density(droplet, temperature_c) - density(fluid, temperature_c)),
        viscosity_pa_s=float(properties.viscosity_pa_s(fluid, temperature_c)),
    )


class MixtureProperties:
    """What can be asked of a material with a `mixture`; a property that its file lacks is an error that names it."""

    def __init__(self, material: MaterialFile) -> None:
        self._name = material.name
        self.mixture: Mixture = self._needed(material.mixture, "mixture")

    @property
    def binodal(self) -> Binodal:
        """Compositions of the coexisting phases."""
        binodal: Binodal | None = self.mixture.binodal
        return self._needed(binodal, "mixture.binodal")

    def density_kg_m3(self, composition: npt.ArrayLike, temperature_c: npt.ArrayLike) -> Floats:
        """Density of a homogeneous mixture."""
        first, second = self.mixture.first, self.mixture.second
        return mixture_density_kg_m3(
            checked_composition(composition),
            (self.pure_density_kg_m3(first, temperature_c), self.pure_density_kg_m3(second, temperature_c)),
            (
                self._needed(first.molar_mass_g_mol, f"molar_mass_g_mol of {first.name}"),
                self._needed(second.molar_mass_g_mol, f"molar_mass_g_mol of {second.name}"),
            ),
            self.mixture.excess_volume,
        )

    def viscosity_pa_s(self, composition: npt.ArrayLike, temperature_c: npt.ArrayLike) -> Floats:
        """Viscosity of a homogeneous mixture (eq. 12)."""
        mixed = self._needed(self.mixture.viscosity, "mixture.viscosity")
        fluids = (self.mixture.first, self.mixture.second)
        pure = [self._needed(fluid.viscosity, f"viscosity of {fluid.name}") for fluid in fluids]
        return mixture_viscosity_pa_s(checked_composition(composition), temperature_c, mixed, pure)

    def pure_density_kg_m3(self, fluid: Fluid, temperature_c: npt.ArrayLike) -> Floats:
        """Density of one of the fluids."""
        density: WaterDensity | ExpandingDensity | None = fluid.density
        if density is None:
            raise self._missing(f"density of {fluid.name}")
        return density.at(temperature_c)

    def _needed(self, value: Value | None, what: str) -> Value:
        if value is None:
            raise self._missing(what)
        return value

    def _missing(self, what: str) -> ExperimentError:
        return ExperimentError(
            f"The material {self._name} has no {what}.",
            code="material.property_missing",
            hint="Add it to the material file.",
        )


def checked_composition(composition: npt.ArrayLike) -> Floats:
    """`composition` as an array; raise `ExperimentError` where it is no mass fraction."""
    phi = np.asarray(composition, np.float64)
    if not np.all((phi >= 0) & (phi <= 1)):
        raise ExperimentError("A composition is a mass fraction from 0 to 1.", code="material.composition_outside")
    return phi


def _without_source(fixed: FixedMaterial) -> FixedMaterial:
    return FixedMaterial(delta_density_kg_m3=fixed.delta_density_kg_m3, viscosity_pa_s=fixed.viscosity_pa_s)
