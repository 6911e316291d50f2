"""Materials and ramps as the API shows them."""

from typing import Any

from pydantic import BaseModel


class Material(BaseModel):
    """A material that comes with the software."""

    name: str
    title: str
    is_illustrative: bool
    """Its numbers show the method; they were not measured."""
    is_mixture: bool
    """Its properties depend on temperature, and it has a phase diagram."""
    first: str | None
    """The fluids of a mixture; compositions are mass fractions of the second."""
    second: str | None
    range_c: tuple[float, float] | None
    """Temperatures at which it has two phases."""


class Materials(BaseModel):
    """The materials that come with the software."""

    items: list[Material]


class Property(BaseModel):
    """One property with its unit and where it comes from."""

    name: str
    value: float
    unit: str
    source: str


class Sedimentation(BaseModel):
    """How fast droplets of some radii move along `up` in one phase, by Stokes' law."""

    phase: str | None
    delta_density_kg_m3: float
    viscosity_pa_s: float
    r_um: list[float]
    speed_um_s: list[float]


class MaterialProperties(BaseModel):
    """Everything that is known of a material at one temperature."""

    material: Material
    temperature_c: float | None
    properties: list[Property]
    sedimentation: list[Sedimentation]


class Ramp(BaseModel):
    """A temperature ramp with a constant driving parameter."""

    driving_per_s: float
    duration_s: float
    total_s: float
    """With mixing and equilibration, where these were asked for."""
    figure: dict[str, Any]
    """As Plotly draws it."""
