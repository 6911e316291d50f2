"""Every figure of a film by its name: what it shows, where the paper has it, how it is computed, and how it is drawn.

The report, the service and the docs take their figures from here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import Any

import plotly.graph_objects as go
import polars as pl

from dropflow import figures
from dropflow.figures import numbers
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings
from dropflow.statistics.oscillations import Signal


class Group(StrEnum):
    """What a figure is about."""

    SIZES = "sizes"
    DROPLETS = "droplets"
    FLOW = "flow"
    TIME = "time"
    FLUID = "fluid"
    FRAME = "frame"


class Needs(StrEnum):
    """After which stage a figure can be drawn."""

    NOTHING = "nothing"
    DETECT = "detect"
    TRACK = "track"
    ANALYSE = "analyse"


@dataclass(frozen=True)
class Parameter:
    """Something that can be asked of a figure."""

    name: str
    kind: str
    """``number``, ``integer`` or ``choice``."""
    description: str
    unit: str | None = None
    is_required: bool = False
    choices: tuple[str, ...] = ()


FROM_S = Parameter("from_s", "number", "Leave out what is before.", "s")
TO_S = Parameter("to_s", "number", "Leave out what is after.", "s")
RADIUS_MIN_UM = Parameter("radius_min_um", "number", "Leave out smaller droplets.", "µm")
RADIUS_MAX_UM = Parameter("radius_max_um", "number", "Leave out larger droplets.", "µm")
SIGNAL = Parameter("signal", "choice", "In what oscillations are looked for.", choices=tuple(Signal))
FRAME = Parameter("frame", "integer", "Which frame.", is_required=True)
ANY_FRAME = Parameter("frame", "integer", "Which frame; without it the one in the middle of the film.")
TRAJECTORY = Parameter("trajectory", "integer", "Which trajectory.", is_required=True)
TIMES, RADII = (FROM_S, TO_S), (RADIUS_MIN_UM, RADIUS_MAX_UM)

Draw = Callable[..., go.Figure]


@dataclass(frozen=True)
class Entry:
    """One figure."""

    name: str
    title: str
    paper: str
    """Where the paper has it."""
    group: Group
    how: str
    """How it is computed, in a sentence or two."""
    docs: str
    """Its page below ``docs/explanation/figures``, without the ending."""
    needs: Needs
    draw: Draw | None = None
    """Takes the findings, title and caption; None for what needs a frame, too."""
    table: Callable[[Findings], pl.DataFrame] | None = None
    """Its numbers."""
    parameters: tuple[Parameter, ...] = ()
    missing: Callable[[FilmFacts], str | None] = lambda facts: None  # noqa: ARG005 - most need nothing of the film
    """Why it cannot be drawn of a film, or None."""


def draw(entry: Entry, found: Findings) -> go.Figure:
    """Draw a figure of a film."""
    assert entry.draw is not None  # noqa: S101 - whoever draws frames knows them by name
    return entry.draw(found, title=entry.title, caption=figures.caption_of(found.facts.caption()))


def _sizes(found: Findings) -> dict[str, Any]:
    return {"area_um2": found.facts.area_um2, "observation_depth_um": found.depth_um}


def _before(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution(found.before, **_sizes(found), **said)


def _after(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution(found.after, **_sizes(found), **said)


def _at(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution_at(found.before, found.after, **_sizes(found), seen=found.seen, **said)


def _moments(found: Findings, **said: Any) -> go.Figure:
    shown = found.after if len(found.after) else found.before
    return figures.moments(shown, **_sizes(found), seen=found.seen, **said)


def _of(draw_part: Draw, part: str) -> Draw:
    """A figure that takes one part of the findings and nothing else."""

    def drawn(found: Findings, **said: Any) -> go.Figure:
        return draw_part(getattr(found, part), **said)

    return drawn


def _depth(found: Findings, **said: Any) -> go.Figure:
    return figures.observed_depth(found.depth, found.whole_lengths.mean_s, **said)


def _growth(found: Findings, **said: Any) -> go.Figure:
    return figures.growth(found.growth, swept_um_s=found.swept_um_s, **said)


def _efficiency(found: Findings, **said: Any) -> go.Figure:
    return figures.collision_efficiency(found.growth, found.swept_um_s, **said)


def _flow_steps(found: Findings, **said: Any) -> go.Figure:
    shown = found.shown_flow
    return figures.flow_moments(shown.time_s, shown.mean_um_s, shown.rms_um_s, **said)


def _flow_bins(found: Findings, **said: Any) -> go.Figure:
    of = found.binned_flow
    errors: dict[str, Any] = {"mean_std_um_s": of.mean_std_um_s, "rms_std_um_s": of.rms_std_um_s}
    return figures.flow_moments(of.time_s, of.mean_um_s, of.rms_um_s, **errors, **said)


def _periods(found: Findings, **said: Any) -> go.Figure:
    of, temperature = found.oscillations, found.temperature
    at_c = temperature.at(of.period_at_s) if temperature is not None and len(of.period_at_s) else None
    return figures.periods(of, temperature_c=at_c, **said)


def _of_mixture(draw_material: Draw) -> Draw:
    def drawn(found: Findings, **said: Any) -> go.Figure:
        return draw_material(found.facts.mixture, **said)

    return drawn


def _no_mixture(facts: FilmFacts) -> str | None:
    return None if facts.mixture else "The experiment's material is no mixture: its numbers are fixed."


def _no_log(facts: FilmFacts) -> str | None:
    return None if facts.experiment.temperature_log else "The experiment has no temperature log."


def _no_driving(facts: FilmFacts) -> str | None:
    return _no_mixture(facts) or _no_log(facts)


_entry = partial(Entry, needs=Needs.ANALYSE)

CATALOGUE: tuple[Entry, ...] = (
    _entry(
        "phase_diagram",
        "Phase diagram",
        "Fig. 1",
        Group.FLUID,
        "Compositions of both phases against temperature, from the material file.",
        "phase-diagram",
        needs=Needs.NOTHING,
        draw=_of_mixture(figures.phase_diagram),
        missing=_no_mixture,
    ),
    _entry(
        "thresholding",
        "Detection by threshold and distance",
        "Fig. 4",
        Group.FRAME,
        "A piece of a frame with many droplets, cleaned, thresholded, its distance map and what is found.",
        "working-panels",
        parameters=(ANY_FRAME,),
    ),
    _entry(
        "watershed",
        "Detection by watershed",
        "Fig. 5",
        Group.FRAME,
        "The same piece with the markers of droplets and background, the gradient with its watershed lines, and what "
        "is found.",
        "working-panels",
        parameters=(ANY_FRAME,),
    ),
    _entry(
        "match",
        "Match of a droplet",
        "eq. 3, section 3.1.3",
        Group.FRAME,
        "Disk and ring on a droplet of the same piece, and the match against its radius and place.",
        "working-panels",
        parameters=(ANY_FRAME,),
    ),
    _entry(
        "flow_field",
        "Flow field",
        "Fig. 6",
        Group.FRAME,
        "Flow between a frame and the next; cells without a droplet are drawn apart.",
        "flow-field",
        needs=Needs.TRACK,
        parameters=(FRAME,),
    ),
    _entry(
        "displacement",
        "Displacement between two frames",
        "Fig. 6",
        Group.FRAME,
        "Droplets of a frame (red), where they are in the next (green), and the flow (arrows).",
        "working-panels",
        needs=Needs.TRACK,
        parameters=(FRAME,),
    ),
    _entry(
        "forward_tracking",
        "Forward tracking",
        "Fig. 7, section 3.3.1",
        Group.FRAME,
        "Sedimentation and advection of a droplet to the next frame, where they predict it, and where it was found.",
        "working-panels",
        needs=Needs.TRACK,
        parameters=(TRAJECTORY, FRAME),
    ),
    _entry(
        "backward_tracking",
        "Backward tracking",
        "Fig. 8, section 3.3.2",
        Group.FRAME,
        "The same from a frame to the one before.",
        "working-panels",
        needs=Needs.TRACK,
        parameters=(TRAJECTORY, FRAME),
    ),
    _entry(
        "velocity_against_radius",
        "Vertical velocity against radius",
        "Fig. 9, section 4.1",
        Group.DROPLETS,
        "Mean velocity along up of trajectories in bins of radius, beside Stokes' law plus the mean flow. Vertical "
        "bars: standard error; horizontal: scatter of the radius.",
        "velocity-against-radius",
        draw=_of(figures.velocity_against_radius, "velocity"),
        table=numbers.velocity,
        parameters=TIMES + RADII,
    ),
    _entry(
        "self_calibration",
        "Velocity against r² among neighbours",
        "section 4.1",
        Group.DROPLETS,
        "Droplets that share a frame and a cell are in the same flow: the slope of velocity against r² among them "
        "gives the density difference over the viscosity without any material data.",
        "self-calibration",
        draw=_of(figures.self_calibration, "calibration"),
        table=numbers.calibration,
    ),
    _entry(
        "trajectory_lengths",
        "Length of trajectories against radius",
        "Fig. 10, section 4.3",
        Group.DROPLETS,
        "Trajectories by mean radius and duration, and the time to sediment through the frame.",
        "trajectory-length",
        draw=_of(figures.trajectory_lengths, "lengths"),
        table=numbers.lengths,
        parameters=TIMES + RADII,
    ),
    _entry(
        "observed_depth",
        "Depth in which droplets are seen",
        "section 4.3",
        Group.DROPLETS,
        "Depth from the mean stay of droplets after what leaves over the borders. An estimate: it takes the flow "
        "through the focal plane to be like the horizontal flow in it.",
        "observed-depth",
        draw=_depth,
        table=numbers.depth,
    ),
    _entry(
        "radius_scatter",
        "Scatter of the radius within trajectories",
        "Fig. 11, section 4.4",
        Group.DROPLETS,
        "Standard deviation of the radius about its own line in time, mean over trajectories.",
        "radius-scatter",
        draw=_of(figures.radius_scatter, "scatter"),
        table=numbers.scatter,
        parameters=TIMES + RADII,
    ),
    _entry(
        "size_distribution_before",
        "Size distribution before the consistency check",
        "Fig. 13a, section 4.5",
        Group.SIZES,
        "All detections, counted by radius and time.",
        "size-distribution",
        needs=Needs.DETECT,
        draw=_before,
        table=lambda found: numbers.distribution(found, found.before),
        parameters=TIMES + RADII,
    ),
    _entry(
        "size_distribution_after",
        "Size distribution after the consistency check",
        "Fig. 13b, section 4.5",
        Group.SIZES,
        "Droplets of the trajectories that were kept, counted by radius and time.",
        "size-distribution",
        needs=Needs.TRACK,
        draw=_after,
        table=lambda found: numbers.distribution(found, found.after),
        parameters=TIMES + RADII,
    ),
    _entry(
        "size_distribution_at",
        "Size distribution of a range of times",
        "section 4.5",
        Group.SIZES,
        "The same as a curve, all frames of the range together. Bars: standard deviation, a droplet that is seen in "
        "several frames counted as one.",
        "size-distribution",
        needs=Needs.DETECT,
        draw=_at,
        table=numbers.distribution_at,
        parameters=TIMES + RADII,
    ),
    _entry(
        "moments",
        "Moments of the size distribution",
        "section 4.5",
        Group.SIZES,
        "Means from exact sums of r^0 to r^3, percentiles from the bins. Bands: standard deviation, a droplet that is "
        "seen in several frames counted as one.",
        "moments",
        needs=Needs.DETECT,
        draw=_moments,
        table=numbers.moments,
        parameters=TIMES + RADII,
    ),
    _entry(
        "flow_moments",
        "Flow over time",
        "Fig. 14, section 4.6",
        Group.FLOW,
        "Mean and rms of both components of the flow over cells computed from droplets, step by step.",
        "flow-moments",
        needs=Needs.TRACK,
        draw=_flow_steps,
        table=numbers.flow_steps,
        parameters=TIMES,
    ),
    _entry(
        "flow_bins",
        "Flow in four bins an oscillation",
        "Fig. 14, section 4.6",
        Group.FLOW,
        "The same in four bins an oscillation, or forty over a film without. Bars: standard error, steps nearer than "
        "the correlation time counted once.",
        "flow-moments",
        draw=_flow_bins,
        table=numbers.flow_bins,
        parameters=(*TIMES, SIGNAL),
    ),
    _entry(
        "flow_correlation",
        "Correlation of the flow",
        "section 3.2.2",
        Group.FLOW,
        "Correlation of the flow's fluctuation over distance and time; dashed where it falls below 1 / e.",
        "flow-correlation",
        draw=_of(figures.flow_correlation, "correlation"),
        table=numbers.correlation,
    ),
    _entry(
        "oscillations",
        "Oscillations",
        "section 4.7",
        Group.TIME,
        "Peaks of the signal over its trend; open ones are uncertain.",
        "oscillations",
        draw=_of(figures.oscillating_signal, "oscillations"),
        table=numbers.signal,
        parameters=(*TIMES, *RADII, SIGNAL),
    ),
    _entry(
        "periods",
        "Periods",
        "section 4.7",
        Group.TIME,
        "Time from each peak to the next, against time, or against temperature where there is a log.",
        "oscillations",
        draw=_periods,
        table=numbers.periods,
        parameters=(*TIMES, *RADII, SIGNAL),
    ),
    _entry(
        "temperature",
        "Temperature over time",
        "section 2.3",
        Group.TIME,
        "The temperature log at the times of the frames.",
        "temperature-and-driving",
        draw=_of(figures.temperature, "shown_temperature"),
        table=numbers.temperature,
        parameters=TIMES,
        missing=_no_log,
    ),
    _entry(
        "driving",
        "Driving parameter over time",
        "eq. 1, section 2.2",
        Group.TIME,
        "Slope of ln Φ₀(T(t)) in windows of ten minutes, from the temperature log and the material's binodal.",
        "temperature-and-driving",
        draw=_of(figures.driving, "driving"),
        table=numbers.driving,
        parameters=TIMES,
        missing=_no_driving,
    ),
    _entry(
        "growth",
        "Growth of droplets against radius",
        "section 5",
        Group.DROPLETS,
        "Slope of radius against time of single trajectories; the dashed line is the growth of droplets that take up "
        "all smaller ones in their way.",
        "growth",
        draw=_growth,
        table=numbers.growth,
        parameters=TIMES + RADII,
    ),
    _entry(
        "collision_efficiency",
        "Collision efficiency against radius",
        "section 5",
        Group.DROPLETS,
        "Measured growth over that of droplets that take up all smaller ones in their way: an upper bound, for "
        "droplets grow by diffusion, too.",
        "growth",
        draw=_efficiency,
        table=numbers.efficiency,
        parameters=TIMES + RADII,
    ),
    _entry(
        "coalescence",
        "Coalescence by size pair",
        "section 5",
        Group.DROPLETS,
        "Two trajectories that end where one begins in the next frame, with the volume of both within 3 sigma.",
        "coalescence",
        draw=_of(figures.coalescence, "rates"),
        table=numbers.coalescence,
        parameters=TIMES + RADII,
    ),
    _entry(
        "viscosity",
        "Viscosity against temperature",
        "Fig. 16, appendix",
        Group.FLUID,
        "Viscosity of both phases and both pure fluids (eqs. 10 to 12), from the material file.",
        "viscosity",
        needs=Needs.NOTHING,
        draw=_of_mixture(figures.viscosity),
        missing=_no_mixture,
    ),
)
"""In the order of the paper."""

BY_NAME = {entry.name: entry for entry in CATALOGUE}
