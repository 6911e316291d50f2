"""The figures of a report, in the order of the paper, each with how it was computed."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import plotly.graph_objects as go
import zarr

from dropflow import figures
from dropflow.physics.material_files import MaterialFile, find_material
from dropflow.report.findings import Findings
from dropflow.results import Results

BEFORE = "Size distribution before the consistency check"
AFTER = "Size distribution after the consistency check"


@dataclass(frozen=True)
class Section:
    """One figure and what to say of it."""

    key: str
    """Stable name, also of the page in the docs."""
    figure: go.Figure
    how: str
    """How it was computed, in a sentence or two."""


def sections(results: Results, found: Findings) -> list[Section]:
    """All figures of an analysis; one without data says so and is drawn empty."""
    caption = figures.caption_of(provenance_of(results))
    made = [
        Section(key, make(caption=caption), how)
        for key, make, how in (*_of_sizes(results, found), *_of_droplets(found))
    ]
    made += [
        Section(key, make(caption=caption), how) for key, make, how in (*_of_flow(results, found), *_of_time(found))
    ]
    material = _mixture(results)
    if material is not None:
        made.append(Section("phase-diagram", figures.phase_diagram(material), "Binodal of the material (Fig. 1)."))
        made.append(Section("viscosity", figures.viscosity(material), "Eqs. (10) to (12) (Fig. 16)."))
    return made


def provenance_of(results: Results) -> dict[str, Any]:
    """What a caption says."""
    experiment, known = results.experiment, results.provenance
    name = experiment.material if isinstance(experiment.material, str) else None
    return {
        "experiment": experiment.name,
        "detection": known["parameters"]["detection"]["method"],
        "tracking": known["parameters"]["tracking"]["method"],
        "material": find_material(name).label if name else None,
        "dropflow": known["dropflow_version"],
        "input": str(known["input_sha256"])[:12],
    }


def _mixture(results: Results) -> MaterialFile | None:
    name = results.experiment.material
    found = find_material(name) if isinstance(name, str) else None
    return found if found is not None and found.mixture is not None else None


Plan = tuple[str, Callable[..., go.Figure], str]


def _of_sizes(results: Results, found: Findings) -> list[Plan]:
    sizes: dict[str, Any] = {"area_um2": results.area_um2, "observation_depth_um": found.depth_um}
    depth = _depth_words(results, found)
    return [
        (
            "size-distribution-before",
            partial(figures.size_distribution, found.before, title=BEFORE, **sizes),
            f"All detections, counted by radius and time (Fig. 13a). {depth}",
        ),
        (
            "size-distribution",
            partial(figures.size_distribution, found.after, title=AFTER, **sizes),
            f"Droplets of the trajectories that were kept (Fig. 13b). {depth}",
        ),
        (
            "moments",
            partial(figures.moments, found.after, **sizes),
            "Means from exact sums of r^0 to r^3, percentiles from the bins; bands are Poisson standard deviations.",
        ),
    ]


def _depth_words(results: Results, found: Findings) -> str:
    given_um = results.experiment.observation_depth_um
    if given_um is not None:
        return f"Per volume, with the experiment's observation depth of {given_um:g} µm."
    if found.depth_um is not None:
        factor = f"{found.depth.per_radius:.2f} ± {found.depth.per_radius_std:.2f}"
        return f"Per volume, with a depth of ({factor}) r estimated from how long droplets stay in sight (section 4.3)."
    return "Per area: the observed depth is unknown."


def _of_droplets(found: Findings) -> list[Plan]:
    return [
        (
            "velocity-against-radius",
            partial(figures.velocity_against_radius, found.velocity),
            "Mean velocity along up of trajectories in bins of radius, beside Stokes' law plus the mean flow (Fig. 9). "
            "Vertical bars: standard error; horizontal: scatter of the radius.",
        ),
        (
            "trajectory-length",
            partial(figures.trajectory_lengths, found.lengths),
            "Trajectories by mean radius and duration, and the time to sediment through the frame (Fig. 10).",
        ),
        (
            "observed-depth",
            partial(figures.observed_depth, found.depth, found.lengths.mean_s),
            "Depth from the mean stay of droplets after what leaves over the borders (section 4.3). An estimate: it "
            "takes the flow through the focal plane to be like the horizontal flow in it.",
        ),
        (
            "radius-scatter",
            partial(figures.radius_scatter, found.scatter),
            "Standard deviation of the radius about its own line in time, mean over trajectories (Fig. 11).",
        ),
        (
            "growth",
            partial(figures.growth, found.growth, swept_um_s=found.swept_um_s),
            "Slope of radius against time of single trajectories; the dashed line is the growth of droplets that take "
            "up all smaller ones in their way (section 5).",
        ),
        (
            "coalescence",
            partial(figures.coalescence, found.rates),
            "Two trajectories that end where one begins in the next frame, with the volume of both within 3 sigma.",
        ),
    ]


def _of_flow(results: Results, found: Findings) -> list[Plan]:
    binned = found.binned_flow
    return [
        (
            "flow-field",
            partial(_flow_field, results),
            "Flow between two frames in the middle of the film (Fig. 6); cells without a droplet are drawn apart.",
        ),
        (
            "flow-moments",
            partial(
                figures.flow_moments,
                binned.time_s,
                binned.mean_um_s,
                binned.rms_um_s,
                mean_std_um_s=binned.mean_std_um_s,
                rms_std_um_s=binned.rms_std_um_s,
            ),
            "Mean and rms over cells computed from droplets, in four bins an oscillation (Fig. 14). Bars: standard "
            "error, steps nearer than the correlation time counted once.",
        ),
        (
            "flow-correlation",
            partial(figures.flow_correlation, found.correlation),
            "Correlation of the flow's fluctuation over distance and time; dashed where it falls below 1 / e (3.2.2).",
        ),
    ]


def _of_time(found: Findings) -> list[Plan]:
    signal = found.oscillations.signal_name.replace("_", " ")
    at_c = None
    if found.temperature is not None and len(found.oscillations.period_at_s):
        at_c = found.temperature.at(found.oscillations.period_at_s)
    return [
        (
            "oscillations",
            partial(figures.oscillating_signal, found.oscillations),
            f"Peaks of the {signal} over its trend (section 4.7); open ones are uncertain.",
        ),
        (
            "periods",
            partial(figures.periods, found.oscillations, temperature_c=at_c),
            "Time from each peak to the next.",
        ),
    ]


def _flow_field(results: Results, *, caption: str) -> go.Figure:
    arrays = {
        name: zarr.open_array(results.flow / name, mode="r")
        for name in ("velocity_um_s", "is_interpolated", "grid_x_px", "grid_y_px")
    }
    n_steps = arrays["velocity_um_s"].shape[0]
    frame = n_steps // 2
    rows, columns = arrays["velocity_um_s"].shape[2:]
    is_there = n_steps > 0
    velocity = np.asarray(arrays["velocity_um_s"][frame]) if is_there else np.full((2, rows, columns), np.nan)
    interpolated = np.asarray(arrays["is_interpolated"][frame]) if is_there else np.ones((rows, columns), bool)
    droplets = results.frame_of_table(results.trajectories, frame)
    return figures.flow_field(
        velocity,
        interpolated,
        np.asarray(arrays["grid_x_px"][:]),
        np.asarray(arrays["grid_y_px"][:]),
        pixel_size_um=results.experiment.pixel_size_um,
        frame=frame,
        droplets_px=tuple(droplets[f"{name}_px"].to_numpy() for name in "xyr"),
        caption=caption,
    )
