"""The droplet size distribution over time as a heat map (Fig. 13), and over a range of times as a curve."""

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import (
    BLUE,
    MAX_COLUMNS,
    SEQUENTIAL,
    SKY,
    log_colour_bar,
    new_figure,
    say_empty,
    time_axis,
)
from dropflow.statistics.histograms import FrameHistograms, coarsen
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.size_distribution import DensityUnit
from dropflow.statistics.size_distribution import size_distribution as density_of

Floats = npt.NDArray[np.float64]

DENSITY_TITLES: dict[DensityUnit, str] = {
    "um^-4": "droplets per volume and radius (µm<sup>−4</sup>)",
    "um^-3": "droplets per area and radius (µm<sup>−3</sup>), depth unknown",
}


def size_distribution(
    histograms: FrameHistograms,
    *,
    area_um2: float,
    observation_depth_um: float | Floats | None = None,
    title: str = "Droplet size distribution",
    caption: str = "",
    max_columns: int = MAX_COLUMNS,
) -> go.Figure:
    """Number density per radius, colour coded on a decadic logarithmic scale, over time and radius (Fig. 13).

    Parameters
    ----------
    histograms
        Counted droplets; neighbouring frames are summed so that at most `max_columns` columns are drawn.
    area_um2
        Area of the sample that one frame shows.
    observation_depth_um
        Depth over which droplets are seen, one number or one per radius bin. Without it the density is per area, in
        um^-3, and the colour bar says so.
    """
    figure = new_figure(title, caption)
    shown = coarsen(histograms, max_columns)
    factor, unit = time_axis(shown.time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text="radius r (µm)", type="log", range=np.log10(shown.edges_um[[0, -1]]).tolist())
    figure.update_yaxes(tickmode="array", tickvals=radius_ticks(shown.edges_um), autorange=False)
    density = density_of(shown, area_um2=area_um2, observation_depth_um=observation_depth_um)
    if not density.density.any():
        return say_empty(figure, "no droplets")
    log_density = np.log10(np.where(density.density > 0, density.density, np.nan))
    low, high = float(np.nanmin(log_density)), float(np.nanmax(log_density))
    time, values = _with_gaps(shown, log_density)
    return figure.add_trace(
        go.Heatmap(
            x=(time * factor).astype(np.float32),
            y=shown.edges_um.astype(np.float32),
            z=values.T.astype(np.float32),
            colorscale=SEQUENTIAL,
            zmin=low,
            zmax=max(high, low + 0.1),
            colorbar=log_colour_bar(DENSITY_TITLES[density.unit], low, high),
            hovertemplate=f"t %{{x:.4g}} {unit}<br>r %{{y:.3g}} µm<br>n 10^%{{z:.2f}} {density.unit}<extra></extra>",
        )
    )


def size_distribution_at(
    before: FrameHistograms,
    after: FrameHistograms,
    *,
    area_um2: float,
    observation_depth_um: float | Floats | None = None,
    seen: InSight | None = None,
    title: str = "Droplet size distribution of a range of times",
    caption: str = "",
) -> go.Figure:
    """Number density against radius, all frames of both histograms together, with standard deviations.

    `before` are all detections, `after` those that tracking leaves; either may have no column.
    """
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text="radius r (µm)", type="log", range=np.log10(before.edges_um[[0, -1]]).tolist())
    figure.update_xaxes(tickmode="array", tickvals=radius_ticks(before.edges_um))
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"})
    is_empty = True
    for part, name, colour in ((before, "all detections", SKY), (after, "after tracking", BLUE)):
        found = density_of(coarsen(part, 1), area_um2=area_um2, observation_depth_um=observation_depth_um, seen=seen)
        figure.update_yaxes(title_text=DENSITY_TITLES[found.unit], type="log", exponentformat="power")
        if not found.density.any():
            continue
        is_empty = False
        known = found.density[0] > 0
        figure.add_scatter(
            x=part.radius_um[known],
            y=found.density[0][known],
            error_y={"array": found.density_std[0][known]},
            mode="lines+markers",
            marker={"size": 5},
            line={"color": colour, "width": 1},
            name=name,
        )
    return say_empty(figure, "no droplets") if is_empty else figure


def _with_gaps(histograms: FrameHistograms, values: Floats) -> tuple[Floats, Floats]:
    """Edges of the columns in time (s), and the values with an empty column where frames are missing between two."""
    time_s = histograms.time_s
    if len(time_s) == 1:
        return np.array([time_s[0] - 0.5, time_s[0] + 0.5]), values
    n_spanned = histograms.last_frame - histograms.first_frame + 1
    distance = np.diff(time_s)
    n_frames_between = (n_spanned[1:] + n_spanned[:-1]) / 2
    frame_s = float(np.median(distance / np.maximum(n_frames_between, 1)))
    starts, ends = time_s - n_spanned * frame_s / 2, time_s + n_spanned * frame_s / 2
    middles = (ends[:-1] + starts[1:]) / 2
    is_gap = histograms.first_frame[1:] > histograms.last_frame[:-1] + 1
    edges, columns = [starts[0]], [values[0]]
    for index, gap in enumerate(is_gap):
        if gap:
            edges += [ends[index], starts[index + 1]]
            columns += [np.full(values.shape[1], np.nan)]
        else:
            edges.append(middles[index])
        columns.append(values[index + 1])
    return np.array([*edges, ends[-1]]), np.array(columns)


def radius_ticks(edges_um: Floats) -> list[float]:
    """1, 2, 3, 5 and their decades within the edges."""
    decades = 10.0 ** np.arange(np.floor(np.log10(edges_um[0])), np.ceil(np.log10(edges_um[-1])) + 1)
    ticks = np.multiply.outer(decades, [1, 2, 3, 5]).ravel()
    return [float(tick) for tick in ticks if edges_um[0] <= tick <= edges_um[-1]]
