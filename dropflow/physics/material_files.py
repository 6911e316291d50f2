"""Materials as YAML files: one per fluid pair, with units in the names of the fields and the source of each number."""

from importlib import resources
from pathlib import Path
from typing import Annotated

from pydantic import Field

from dropflow import documents
from dropflow.documents import StrictModel
from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import FixedMaterial

SourceText = Annotated[str, Field(min_length=1, max_length=2000)]


class FixedProperties(FixedMaterial):
    """Density difference and viscosity that hold at one temperature, and where they come from."""

    source: SourceText
    """Where the numbers come from."""


class MaterialFile(StrictModel):
    """One fluid pair."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=100)]
    """What an experiment calls it."""
    title: Annotated[str, Field(min_length=1, max_length=200)]
    """One line for people."""
    is_illustrative: bool
    """True where numbers are plausible and not measured; every figure that uses them says so."""
    fixed: FixedProperties
    """Values that do not depend on temperature."""


def packaged_directory() -> Path:
    """The folder of the material files that come with Dropflow."""
    return Path(str(resources.files("dropflow.physics"))) / "materials"


def known_names() -> tuple[str, ...]:
    """The names of the packaged materials, sorted."""
    return tuple(sorted(path.stem for path in packaged_directory().glob("*.yaml")))


def load_material_file(path: Path) -> MaterialFile:
    """Read one material file; raise `ExperimentError` naming each wrong field."""
    return documents.load(MaterialFile, path, ExperimentError)


def find_material(name: str) -> MaterialFile:
    """The packaged material called `name`; raise `ExperimentError` on ``material`` if there is none."""
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
