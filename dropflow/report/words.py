"""What a report says in words: warnings, methods, and the numbers at a glance."""

import math
from collections.abc import Mapping
from typing import Any

from dropflow.figures.layout import with_error
from dropflow.statistics.findings import Findings

Summary = Mapping[str, Any]
"""What ``summary.json`` holds."""

_FEW_TRAJECTORIES = 100
_MUCH_PREDICTED = 0.3


def warnings_of(found: Findings, summary: Summary) -> list[str]:
    """What a reader must know before trusting the figures, in plain words."""
    said = [str(warning["message"]) for warning in summary.get("warnings", [])]
    calibration = found.calibration.warning()
    if calibration:
        said.append(calibration)
    material = found.facts.material_file
    if material is not None and material.is_illustrative:
        said.append(f"The material {material.name} is illustrative: its binodal and densities are not measured.")
    if len(found.trajectories) < _FEW_TRAJECTORIES:
        said.append(f"There are only {len(found.trajectories)} trajectories: all statistics are uncertain.")
    if "n_counted" not in summary.get("tracked", {}):
        said.append(
            "An older version made this analysis: its size distribution counts droplets out of focus as well, each "
            "with the radius of the single frame. Analyse the film again for the radii of whole trajectories."
        )
    predicted = summary.get("tracked", {}).get("found_by_prediction_share")
    if predicted is not None and predicted > _MUCH_PREDICTED:
        said.append(f"{100 * predicted:.0f} % of the droplets were found by prediction only: look at detection.")
    n_uncertain = int((~found.oscillations.is_certain).sum())
    if n_uncertain:
        said.append(f"{n_uncertain} of {len(found.oscillations.peak_s)} oscillations are uncertain.")
    if found.depth_um is None:
        said.append("The observed depth is unknown: densities are per area.")
    elif found.facts.experiment.observation_depth_um is None:
        said.append("The observed depth is an estimate from trajectories: give observation_depth_um if you know it.")
    return said


def methods_of(found: Findings, summary: Summary) -> str:
    """A paragraph for the methods section of a paper."""
    experiment, parameters = found.facts.experiment, found.facts.parameters
    detection = parameters.detection
    delta_density = with_error(found.material.delta_density_kg_m3, unit="kg/m³")
    return (
        f"{found.facts.n_frames} frames of {found.facts.field_um[0]:.0f} × {found.facts.field_um[1]:.0f} µm² "
        f"({experiment.pixel_size_um:g} µm per pixel) over {float(summary['duration_s']):.0f} s were analysed "
        f"with Dropflow {found.facts.provenance['dropflow_version']} (detection: {detection.method}, tracking: "
        f"{parameters.tracking.method}) after Lapp, Rohloff, Vollmer and Hof, Particle tracking for polydisperse "
        f"sedimenting droplets in phase separation, Exp. Fluids. Droplets with radii from {detection.radius_min_um:g} "
        f"to {detection.radius_max_um:g} µm were detected. Their velocities were split into the Stokes velocity "
        f"(density difference {delta_density}, viscosity "
        f"{found.material.viscosity_pa_s:.3g} Pa s) and the flow, which was computed on {parameters.flow.n_columns} × "
        f"{parameters.flow.n_rows} cells. {len(found.trajectories)} trajectories passed the consistency check."
    )


def numbers_of(found: Findings, summary: Summary) -> dict[str, str]:
    """The numbers at a glance, with units."""
    tracked = summary["tracked"]
    calibration, law = found.calibration, found.oscillations.period_s
    rejected = summary.get("n_rejected_trajectories", {})
    return {
        "frames": str(found.facts.n_frames),
        "duration": f"{float(summary['duration_s']):.1f} s",
        "droplets detected": str(summary["detected"]["n_droplets"]),
        "droplets in trajectories": str(tracked["n_droplets"]),
        "of these out of focus": _share(tracked.get("out_of_focus_share")),
        "trajectories": str(len(found.trajectories)),
        "rejected trajectories": ", ".join(f"{count} {reason}" for reason, count in rejected.items()) or "none",
        "mean radius": _known(tracked["mean_radius_um"], "µm"),
        "Sauter radius": _known(tracked["sauter_radius_um"], "µm"),
        "relative scatter of radii": with_error(100 * found.scatter.relative, 100 * found.scatter.relative_std, "%"),
        "Δρ/η from velocities": with_error(calibration.density_over_viscosity_s_m2, calibration.std_s_m2, "s/m²"),
        "Δρ/η of the material": with_error(found.calibration.expected_s_m2, unit="s/m²"),
        "correlation length of the flow": with_error(
            found.correlation.length_um, found.correlation.length_std_um, "µm"
        ),
        "correlation time of the flow": with_error(found.correlation.time_s, found.correlation.time_std_s, "s"),
        "coalescences": str(len(found.events)),
        "oscillations": str(len(found.oscillations.peak_s)),
        "mean period": _known(float(law.mean()) if len(law) else None, "s"),
        "driving parameter ξ": _driving(found),
        "depth over radius": with_error(found.depth.per_radius, found.depth.per_radius_std, ""),
    }


def _known(value: float | None, unit: str) -> str:
    return with_error(math.nan if value is None else value, unit=unit)


def _share(value: float | None) -> str:
    return "not known" if value is None else f"{100 * value:.1f} %"


def _driving(found: Findings) -> str:
    driving = found.driving
    return "not known" if driving is None else with_error(driving.mean_per_s, driving.mean_std_per_s, "1/s")


def parameters_of(found: Findings) -> dict[str, Any]:
    """Experiment and parameters as one document."""
    return {
        "experiment": found.facts.experiment.model_dump(mode="json", exclude_none=True),
        "parameters": found.facts.parameters.model_dump(mode="json"),
        "input_sha256": found.facts.provenance["input_sha256"],
        "dropflow_version": found.facts.provenance["dropflow_version"],
    }
