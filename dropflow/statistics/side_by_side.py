"""The numbers of several analyses side by side, and in what their documents differ."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Document = Mapping[str, Any]


@dataclass(frozen=True)
class KeyNumber:
    """A number of ``summary.json``."""

    name: str
    """Its dotted path there."""
    title: str
    unit: str | None = None
    std: str | None = None
    """Dotted path of its standard error, where it has one."""


def _of_sizes(stage: str, words: str) -> tuple[KeyNumber, ...]:
    return (
        KeyNumber(f"{stage}.n_droplets", f"Droplets {words}"),
        KeyNumber(f"{stage}.n_droplets_per_frame", f"Droplets {words}, a frame"),
        KeyNumber(f"{stage}.mean_radius_um", f"Mean radius, {words}", "µm"),
        KeyNumber(f"{stage}.radius_std_um", f"Standard deviation of radii, {words}", "µm"),
        KeyNumber(f"{stage}.sauter_radius_um", f"Sauter radius, {words}", "µm"),
    )


def _statistic(name: str, title: str, unit: str | None = None) -> KeyNumber:
    """A statistic ``name_unit`` with its standard error ``name_std_unit``."""
    ending = {"s/m²": "_s_m2", "µm": "_um", "s": "_s", "1/s": "_per_s", None: ""}[unit]
    path = f"statistics.{name}"
    return KeyNumber(f"{path}{ending}", title, unit, std=f"{path}_std{ending}")


KEY_NUMBERS: tuple[KeyNumber, ...] = (
    KeyNumber("n_frames", "Frames"),
    KeyNumber("duration_s", "Duration", "s"),
    *_of_sizes("detected", "detected"),
    *_of_sizes("tracked", "tracked"),
    KeyNumber("tracked.found_by_prediction_share", "Share found by prediction"),
    KeyNumber("n_trajectories", "Trajectories"),
    KeyNumber("mean_trajectory_frames", "Mean length of trajectories, frames"),
    KeyNumber("flow.mean_u_um_s", "Flow along x, mean", "µm/s"),
    KeyNumber("flow.mean_v_um_s", "Flow along y, mean", "µm/s"),
    KeyNumber("flow.rms_u_um_s", "Flow along x, rms", "µm/s"),
    KeyNumber("flow.rms_v_um_s", "Flow along y, rms", "µm/s"),
    KeyNumber("flow.computed_share", "Share of cells computed from droplets"),
    KeyNumber("delta_density_kg_m3", "Density difference of the material", "kg/m³"),
    KeyNumber("viscosity_pa_s", "Viscosity of the material", "Pa s"),
    _statistic("density_over_viscosity", "Δρ/η from velocities", "s/m²"),
    KeyNumber("statistics.density_over_viscosity_of_material_s_m2", "Δρ/η of the material", "s/m²"),
    _statistic("relative_radius_scatter", "Relative scatter of radii"),
    _statistic("correlation_length", "Correlation length of the flow", "µm"),
    _statistic("correlation_time", "Correlation time of the flow", "s"),
    _statistic("depth_per_radius", "Observed depth over radius"),
    KeyNumber("statistics.n_coalescences", "Coalescences"),
    KeyNumber("statistics.n_oscillations", "Oscillations"),
    KeyNumber("statistics.n_uncertain_oscillations", "Oscillations that are uncertain"),
    KeyNumber("statistics.mean_period_s", "Mean period", "s"),
    _statistic("driving", "Driving parameter ξ", "1/s"),
)
"""In the order of an analysis."""


def at(document: Document | None, path: str) -> Any:
    """What stands at a dotted path, or None."""
    found: Any = document
    for name in path.split("."):
        found = found.get(name) if isinstance(found, Mapping) else None
    return found


def flat(content: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Everything in a document under its dotted name; lists are values."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from flat(value, f"{name}.{key}".lstrip("."))
    else:
        yield name, content


def differing(documents: Sequence[Document]) -> dict[str, list[Any]]:
    """The values of all documents, by dotted name, where not all are alike; None where a document lacks it."""
    columns = [dict(flat(document)) for document in documents]
    names = dict.fromkeys(name for column in columns for name in column)
    rows = {name: [column.get(name) for column in columns] for name in names}
    return {name: row for name, row in rows.items() if len({json.dumps(value, sort_keys=True) for value in row}) > 1}
