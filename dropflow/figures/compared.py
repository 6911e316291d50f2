"""Several analyses in one figure, a colour each: sizes, moments, velocities, flow, and periods against driving."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
import polars as pl

from dropflow.figures import numbers
from dropflow.figures.catalogue import BY_NAME, RANGES
from dropflow.figures.entry import SIGNAL, Needs, Parameter
from dropflow.figures.layout import MAX_COLUMNS, new_figure, say_empty, stacked_axes, time_axis
from dropflow.figures.oscillations import periods_against_driving
from dropflow.figures.size_distribution import DENSITY_TITLES, radius_ticks
from dropflow.statistics.comparison import DrivenPeriods, LeftOut, driven_periods, law_of, table_of
from dropflow.statistics.findings import Findings
from dropflow.statistics.histograms import coarsen
from dropflow.statistics.size_distribution import size_distribution as density_of
from dropflow.statistics.size_distribution import size_moments

Floats = npt.NDArray[np.floating]


@dataclass(frozen=True)
class Compared:
    """One of the analyses."""

    label: str
    """What it is called in the legend: its own."""
    colour: str
    found: Findings


Draw = Callable[[Sequence[Compared], str], go.Figure]


@dataclass(frozen=True)
class ComparedEntry:
    """One figure of several analyses."""

    name: str
    title: str
    how: str
    docs: str
    needs: Needs
    draw: Draw
    """Takes the analyses and the title."""
    table: Callable[[Findings], pl.DataFrame]
    """The numbers of one of them."""
    parameters: tuple[Parameter, ...]
    left_out: Callable[[Compared], str | None] = lambda one: None  # noqa: ARG005 - most take any
    """Why an analysis has no place in it, or None."""


def table_of_all(entry: ComparedEntry, compared: Sequence[Compared]) -> pl.DataFrame:
    """The numbers of all, one below the other, with the label of each in the column ``run``."""
    parts = [
        entry.table(one.found).select(pl.lit(one.label).alias("run"), pl.all()).cast({"run": pl.String})
        for one in compared
    ]
    # A density is per volume in one analysis and per area in another: columns of their own.
    return pl.concat(parts, how="diagonal") if parts else pl.DataFrame(schema={"run": pl.String})


def _figure(title: str, height_px: int = 520) -> go.Figure:
    figure = new_figure(title, width_px=860, height_px=height_px)
    return figure.update_layout(legend={"x": 1.01, "y": 1, "xanchor": "left"}, margin={"r": 200})


def _common_depths(compared: Sequence[Compared]) -> list[float | npt.NDArray[np.float64] | None]:
    """Per volume only where the depth is known of all: else they could not be held against each other."""
    depths = [one.found.depth_um for one in compared]
    return [None] * len(depths) if any(depth is None for depth in depths) else depths


def _sizes(compared: Sequence[Compared], title: str) -> go.Figure:
    figure = _figure(title)
    figure.update_xaxes(title_text="radius r (µm)", type="log")
    edges_um = np.concatenate([one.found.before.edges_um[[0, -1]] for one in compared] or [np.array([1.0, 10.0])])
    figure.update_xaxes(range=np.log10([edges_um.min(), edges_um.max()]).tolist())
    figure.update_xaxes(tickmode="array", tickvals=radius_ticks(np.sort(edges_um)))
    for one, depth_um in zip(compared, _common_depths(compared), strict=True):
        part = coarsen(one.found.shown_sizes, 1)
        of = density_of(part, area_um2=one.found.facts.area_um2, observation_depth_um=depth_um, seen=one.found.seen)
        figure.update_yaxes(title_text=DENSITY_TITLES[of.unit], type="log", exponentformat="power")
        if of.density.any():
            known = of.density[0] > 0
            _line(figure, one, part.radius_um[known], of.density[0][known], std=of.density_std[0][known])
    return figure if figure.data else say_empty(figure, "no droplets")


def _moments(compared: Sequence[Compared], title: str) -> go.Figure:
    figure = _figure(title, height_px=760)
    shown = [coarsen(one.found.shown_sizes, MAX_COLUMNS) for one in compared]
    factor, unit = time_axis(np.concatenate([of.time_s for of in shown] or [np.empty(0)]))
    depths = _common_depths(compared)
    fraction = "area fraction" if any(depth is None for depth in depths) else "volume fraction"
    stacked_axes(figure, [fraction, "radius (µm)", "droplets per frame"])
    figure.update_layout(xaxis={"title": {"text": f"time t ({unit})"}})
    for one, of, depth_um in zip(compared, shown, depths, strict=True):
        if not of.counts.any():
            continue
        found = size_moments(of, area_um2=one.found.facts.area_um2, observation_depth_um=depth_um)
        time = of.time_s * factor
        _line(figure, one, time, found.n_per_frame, axis="y3")
        _line(figure, one, time, found.mean_radius_um, axis="y2", dash="dot", is_named=False)
        _line(figure, one, time, found.sauter_radius_um, axis="y2", is_named=False)
        _line(figure, one, time, found.fraction, is_named=False)
    _say_lines(figure, "radius: — Sauter, ··· mean")
    return figure if figure.data else say_empty(figure, "no droplets")


def _velocities(compared: Sequence[Compared], title: str) -> go.Figure:
    figure = _figure(title)
    figure.update_xaxes(title_text="radius r (µm)")
    figure.update_yaxes(title_text="velocity along up (µm/s)")
    for one in compared:
        measured = one.found.velocity.measured
        known = measured.n > 0
        if known.any():
            std = np.nan_to_num(measured.standard_error[known])
            _line(figure, one, measured.x[known], measured.mean[known], std=std, mode="markers")
            expected = one.found.velocity.expected_um_s[known]
            _line(figure, one, measured.x[known], expected, dash="dot", is_named=False)
    _say_lines(figure, "● measured<br>··· Stokes + mean flow")
    return figure if figure.data else say_empty(figure, "no trajectories")


def _flow(compared: Sequence[Compared], title: str) -> go.Figure:
    figure = _figure(title, height_px=620)
    flows = [one.found.shown_flow for one in compared]
    factor, unit = time_axis(np.concatenate([flow.time_s for flow in flows] or [np.empty(0)]))
    stacked_axes(figure, ["vertical flow (µm/s)", "horizontal flow (µm/s)"])
    figure.update_layout(xaxis={"title": {"text": f"time t ({unit})"}})
    for one, flow in zip(compared, flows, strict=True):
        if not np.isfinite(flow.rms_um_s).any():
            continue
        for component, axis in ((1, "y"), (0, "y2")):
            time = flow.time_s * factor
            _line(figure, one, time, flow.rms_um_s[:, component], axis=axis, is_named=axis == "y")
            _line(figure, one, time, flow.mean_um_s[:, component], axis=axis, dash="dot", is_named=False)
    _say_lines(figure, "— rms, ··· mean")
    return figure if figure.data else say_empty(figure, "no flow: no droplet was followed")


def _periods(compared: Sequence[Compared], title: str) -> go.Figure:
    driven = [one for one in map(_driven, compared) if isinstance(one, DrivenPeriods)]
    of_each = {one.name: (one.driving_per_s, one.period_s) for one in driven}
    return periods_against_driving(of_each, law=law_of(driven), title=title)


def _driven(one: Compared) -> DrivenPeriods | LeftOut:
    return driven_periods(one.label, one.found)


def _undriven(one: Compared) -> str | None:
    driven = _driven(one)
    return driven.reason if isinstance(driven, LeftOut) else None


def _periods_table(found: Findings) -> pl.DataFrame:
    driven = driven_periods("", found)
    return table_of([driven] if isinstance(driven, DrivenPeriods) else []).drop("experiment")


def _line(
    figure: go.Figure,
    one: Compared,
    x: Floats,
    y: Floats,
    *,
    std: Floats | None = None,
    axis: str = "y",
    mode: str = "lines",
    dash: str = "solid",
    is_named: bool = True,
) -> None:
    """A line in the colour of an analysis; those of one analysis are shown and hidden together."""
    figure.add_scatter(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        error_y=None if std is None else {"array": std.astype(np.float32), "width": 2, "thickness": 1},
        yaxis=axis,
        mode=mode,
        marker={"size": 7},
        line={"color": one.colour, "width": 1.5, "dash": dash},
        name=one.label,
        legendgroup=one.label,
        showlegend=is_named,
    )


def _say_lines(figure: go.Figure, what: str) -> None:
    """What kinds of line there are, below the legend."""
    figure.add_annotation(
        text=what, x=1.01, y=0, xref="paper", yref="paper", xanchor="left", align="left", showarrow=False
    )


def _like(name: str, draw: Draw, title: str, table: Callable[[Findings], pl.DataFrame]) -> ComparedEntry:
    """A figure that each analysis has by itself, too."""
    entry = BY_NAME[name]
    return ComparedEntry(name, title, entry.how, entry.docs, entry.needs, draw, table, entry.drawing.parameters)


COMPARED: tuple[ComparedEntry, ...] = (
    _like("size_distribution_at", _sizes, "Size distributions of a range of times", numbers.distribution_at),
    _like("moments", _moments, "Moments of the size distributions", numbers.moments),
    _like("velocity_against_radius", _velocities, "Vertical velocity against radius", numbers.velocity),
    _like("flow_moments", _flow, "Flow over time", numbers.flow_steps),
    ComparedEntry(
        "periods_against_driving",
        "Periods against the driving parameter",
        "Certain periods of each experiment against the mean driving parameter of its temperature log, grouped as in "
        "Fig. 15, with the fitted exponent beside the −3/7 of the later theory.",
        "periods-against-driving",
        Needs.ANALYSE,
        _periods,
        _periods_table,
        (*RANGES, SIGNAL),
        _undriven,
    ),
)
"""In the order of the paper."""

COMPARED_BY_NAME = {entry.name: entry for entry in COMPARED}
