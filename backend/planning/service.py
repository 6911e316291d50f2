"""What a planned experiment needs to know: nothing here touches the database."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import plotly.graph_objects as go

from backend.planning.errors import NoSuchMaterial
from backend.planning.schemas import Material, MaterialProperties, Materials, Property, Ramp, Sedimentation
from dropflow import figures
from dropflow.errors import ExperimentError
from dropflow.experiment import FixedMaterial, Phase
from dropflow.physics.material import MixtureProperties, resolve_at
from dropflow.physics.material_files import MaterialFile, find_material, known_names
from dropflow.physics.material_report import describe
from dropflow.physics.ramp import Protocol, ramp_csv, temperature_ramp
from dropflow.physics.ramp import Ramp as MadeRamp
from dropflow.physics.stokes import sedimentation_um_s

RADII_UM = (5.0, 10.0, 20.0, 40.0)


@dataclass(frozen=True)
class RampWish:
    """A ramp as it is asked for."""

    start_c: float
    end_c: float
    driving_per_s: float | None
    duration_s: float | None
    has_protocol: bool


def materials() -> Materials:
    """All of them, by name."""
    return Materials(items=[_shown(find_material(name)) for name in known_names()])


def properties(name: str, temperature_c: float | None) -> MaterialProperties:
    """What is known of one; without a temperature, in the middle of the range in which it has two phases."""
    material = _find(name)
    shown = _shown(material)
    if temperature_c is None and shown.range_c is not None:
        temperature_c = sum(shown.range_c) / 2
    report = describe(material, temperature_c=temperature_c)
    return MaterialProperties(
        material=shown,
        temperature_c=temperature_c,
        properties=[Property(name=name, **entry) for name, entry in report["properties"].items()],
        sedimentation=list(_sedimentation(material, temperature_c)),
    )


def phase_diagram(name: str) -> dict[str, Any]:
    """Fig. 1 of one material, as Plotly draws it."""
    return _drawn(figures.phase_diagram(_find(name)))


def viscosity(name: str) -> dict[str, Any]:
    """Fig. 16 of one material, as Plotly draws it."""
    return _drawn(figures.viscosity(_find(name)))


def ramp(name: str, wish: RampWish) -> Ramp:
    """A ramp and how it looks."""
    made = _made(name, wish)
    before_s = Protocol().mixing_s + Protocol().equilibration_s if wish.has_protocol else 0.0
    return Ramp(
        driving_per_s=made.driving_per_s,
        duration_s=made.duration_s,
        total_s=before_s + made.duration_s,
        figure=_drawn(figures.temperature_ramp(made, _find(name))),
    )


def ramp_rows(name: str, wish: RampWish) -> Iterator[str]:
    """Set points, one a second, as a controller takes them."""
    return ramp_csv(_made(name, wish), Protocol() if wish.has_protocol else None)


@lru_cache(maxsize=32)
def _made(name: str, wish: RampWish) -> MadeRamp:
    """Looking and downloading ask for the same ramp, which takes a moment to integrate."""
    return temperature_ramp(
        MixtureProperties(_find(name)).binodal,
        start_c=wish.start_c,
        end_c=wish.end_c,
        driving_per_s=wish.driving_per_s,
        duration_s=wish.duration_s,
    )


def _find(name: str) -> MaterialFile:
    if name not in known_names():
        raise NoSuchMaterial
    return find_material(name)


def _shown(material: MaterialFile) -> Material:
    mixture = material.mixture
    binodal = mixture.binodal if mixture is not None else None
    return Material(
        name=material.name,
        title=material.title,
        is_illustrative=material.is_illustrative,
        is_mixture=mixture is not None,
        first=mixture.first.name if mixture is not None else None,
        second=mixture.second.name if mixture is not None else None,
        range_c=binodal.range_c if binodal is not None else None,
    )


def _sedimentation(material: MaterialFile, temperature_c: float | None) -> Iterator[Sedimentation]:
    """In every phase for which the file says enough."""
    if material.fixed is not None:
        fixed = material.fixed
        yield _falling(None, fixed)
    elif temperature_c is not None:
        for phase in Phase:
            try:
                found = resolve_at(material, temperature_c=temperature_c, phase=phase)
            except (
                ExperimentError
            ):  # one phase there, or a property that the file lacks: `properties` shows what it has
                continue
            yield _falling(phase, found)


def _falling(phase: Phase | None, fluid: FixedMaterial) -> Sedimentation:
    about = {"delta_density_kg_m3": fluid.delta_density_kg_m3, "viscosity_pa_s": fluid.viscosity_pa_s}
    return Sedimentation(
        phase=phase, r_um=list(RADII_UM), speed_um_s=sedimentation_um_s(RADII_UM, **about).tolist(), **about
    )


def _drawn(figure: go.Figure) -> dict[str, Any]:
    drawn: dict[str, Any] = json.loads(figure.to_json())
    return drawn
