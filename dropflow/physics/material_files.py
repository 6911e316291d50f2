"""Materials as YAML files: one per fluid pair, with units in the names of the fields and the source of each number."""

from importlib import resources
from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from dropflow import documents
from dropflow.documents import StrictModel
from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import FixedMaterial
from dropflow.physics.binodal import ScalingBinodal, TableBinodal
from dropflow.physics.density import ExcessVolume, ExpandingDensity, WaterDensity
from dropflow.physics.viscosity import CompositionViscosity, PureViscosity, SourceText


class FixedProperties(FixedMaterial):
    """Density difference and viscosity that hold at one temperature, and where they come from."""

    source: SourceText
    """Where the numbers come from."""


class Fluid(StrictModel):
    """One of the two fluids, pure."""

    name: Annotated[str, Field(min_length=1, max_length=100)]
    molar_mass_g_mol: Annotated[float, Field(gt=0)] | None = None
    """Needed for the density of a mixture."""
    density: WaterDensity | ExpandingDensity | None = None
    """Density against temperature."""
    viscosity: PureViscosity | None = None
    """Viscosity against temperature."""


class Mixture(StrictModel):
    """Two fluids that demix. Compositions are mass fractions of the second. What is left out cannot be asked for."""

    first: Fluid
    """The fluid at composition 0."""
    second: Fluid
    """The fluid at composition 1."""
    excess_volume: ExcessVolume | None = None
    """Excess molar volume; without it volumes add up."""
    viscosity: CompositionViscosity | None = None
    """Viscosity against composition at one temperature."""
    binodal: ScalingBinodal | TableBinodal | None = None
    """Compositions of the coexisting phases."""


class MaterialFile(StrictModel):
    """One fluid pair: numbers that hold at one temperature (`fixed`), or how they depend on it (`mixture`)."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=100)]
    """What an experiment calls it."""
    title: Annotated[str, Field(min_length=1, max_length=200)]
    """One line for people."""
    is_illustrative: bool
    """True where numbers are plausible and not measured; every figure that uses them says so."""
    fixed: FixedProperties | None = None
    """Values that do not depend on temperature."""
    mixture: Mixture | None = None
    """A pair of fluids over a range of temperatures."""

    @model_validator(mode="after")
    def _one_kind(self) -> "MaterialFile":
        if (self.fixed is None) == (self.mixture is None):
            raise ValueError("give either fixed or mixture")
        return self

    @property
    def label(self) -> str:
        """The name for captions and provenance, which says when the numbers are not measured."""
        return f"{self.name} (illustrative, not measured)" if self.is_illustrative else self.name


def packaged_directory() -> Path:
    """The folder of the material files that come with Dropflow."""
    return Path(str(resources.files("dropflow.physics"))) / "materials"


def known_names() -> tuple[str, ...]:
    """The names of the packaged materials, sorted."""
    return tuple(sorted(path.stem for path in packaged_directory().glob("*.yaml")))


def load_material_file(path: Path) -> MaterialFile:
    """Read one material file; raise `ExperimentError` naming each wrong field."""
    return documents.load(MaterialFile, path, ExperimentError)


def find_material(name: str, *, beside: Path | None = None) -> MaterialFile:
    """The packaged material called `name`, or the file of that name (ending in .yaml) in the folder `beside`.

    Raises
    ------
    ExperimentError
        Field ``material``: there is none; it lists the names there are.
    """
    if beside is not None and name.endswith((".yaml", ".yml")):
        return load_material_file(beside / name)
    if name not in known_names():
        problem = FieldProblem(
            "material", f"there is no material called {name!r}; known are {', '.join(known_names())}"
        )
        raise ExperimentError(
            "The material is unknown.",
            code="experiment.material_unknown",
            fields=[problem],
            hint="Choose one of them or give delta_density_kg_m3 and viscosity_pa_s.",
        )
    return load_material_file(packaged_directory() / f"{name}.yaml")
