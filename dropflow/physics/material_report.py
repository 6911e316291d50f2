"""Every property of a material at one temperature, each with unit and source: what `dropflow material` prints."""

from pathlib import Path
from typing import Any

from dropflow.experiment import Phase
from dropflow.physics.material import MixtureProperties, resolve_at
from dropflow.physics.material_files import Fluid, MaterialFile, find_material, load_material_file


def find_or_load(name: str) -> MaterialFile:
    """A packaged material by its name, or a material file by its path."""
    if name.endswith((".yaml", ".yml")):
        return load_material_file(Path(name))
    return find_material(name)


def describe(
    material: MaterialFile, *, temperature_c: float | None = None, composition: float | None = None
) -> dict[str, Any]:
    """A JSON document of all properties; those that the file lacks are left out.

    Parameters
    ----------
    temperature_c
        Needed for mixtures.
    composition
        Mass fraction of the second fluid: adds density and viscosity of the homogeneous mixture.
    """
    report = {
        "name": material.name,
        "title": material.title,
        "is_illustrative": material.is_illustrative,
        "temperature_c": temperature_c,
        "composition": composition,
    }
    if material.fixed is not None:
        source = material.fixed.source
        properties = {
            "delta_density": _entry(material.fixed.delta_density_kg_m3, "kg/m3", source),
            "viscosity": _entry(material.fixed.viscosity_pa_s, "Pa s", source),
        }
    elif temperature_c is None:
        properties = {}
    else:
        properties = _of_mixture(material, temperature_c, composition)
    return {**report, "properties": properties}


def _of_mixture(material: MaterialFile, temperature_c: float, composition: float | None) -> dict[str, Any]:
    asked = MixtureProperties(material)
    mixture = asked.mixture
    found: dict[str, Any] = {}
    for fluid in (mixture.first, mixture.second):
        found |= _of_fluid(fluid, temperature_c)
    density_source = _sources(mixture.first.density, mixture.second.density, mixture.excess_volume)
    viscosity_source = _sources(mixture.viscosity, mixture.first.viscosity, mixture.second.viscosity)
    has_density = all(
        fluid.density is not None and fluid.molar_mass_g_mol is not None for fluid in (mixture.first, mixture.second)
    )
    has_viscosity = None not in (mixture.viscosity, mixture.first.viscosity, mixture.second.viscosity)
    if composition is not None and has_density:
        found["density"] = _entry(asked.density_kg_m3(composition, temperature_c), "kg/m3", density_source)
    if composition is not None and has_viscosity:
        found["viscosity"] = _entry(asked.viscosity_pa_s(composition, temperature_c), "Pa s", viscosity_source)
    binodal = mixture.binodal
    if binodal is None or not binodal.range_c[0] < temperature_c <= binodal.range_c[1]:
        return found
    bottom, top = binodal.phases(temperature_c)
    found["composition_bottom"] = _entry(bottom, "mass fraction", binodal.source)
    found["composition_top"] = _entry(top, "mass fraction", binodal.source)
    found["gap_half_width"] = _entry(binodal.half_width(temperature_c), "mass fraction", binodal.source)
    found["gap_half_width_slope"] = _entry(binodal.half_width_slope_per_k(temperature_c), "1/K", binodal.source)
    if has_density and has_viscosity:
        source = f"{density_source}; {viscosity_source}; {binodal.source}"
        for phase in Phase:
            droplets = resolve_at(material, temperature_c=temperature_c, phase=phase)
            found[f"{phase}_phase_delta_density"] = _entry(droplets.delta_density_kg_m3, "kg/m3", source)
            found[f"{phase}_phase_viscosity"] = _entry(droplets.viscosity_pa_s, "Pa s", source)
    return found


def _of_fluid(fluid: Fluid, temperature_c: float) -> dict[str, Any]:
    key = fluid.name.replace(" ", "_")
    found = {}
    if fluid.density is not None:
        found[f"{key}_density"] = _entry(fluid.density.at(temperature_c), "kg/m3", fluid.density.source)
    if fluid.viscosity is not None:
        found[f"{key}_viscosity"] = _entry(fluid.viscosity.at(temperature_c), "Pa s", fluid.viscosity.source)
    return found


def _entry(value: Any, unit: str, source: str) -> dict[str, Any]:
    return {"value": float(value), "unit": unit, "source": source}


def _sources(*parts: Any) -> str:
    return "; ".join(dict.fromkeys(part.source for part in parts if part is not None))
