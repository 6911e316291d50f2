"""Velocity, scatter of the radius, length and growth of trajectories against radius (Figs. 9 to 11, section 5)."""

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import (
    BLACK,
    BLUE,
    ORANGE,
    SEQUENTIAL,
    VERMILION,
    log_colour_bar,
    new_figure,
    say_empty,
    time_axis,
)
from dropflow.statistics.binned import BinnedMean
from dropflow.statistics.growth import Growth
from dropflow.statistics.lengths import ObservedDepth, TrajectoryLengths
from dropflow.statistics.sedimentation import RadiusScatter, VelocityByRadius

Floats = npt.NDArray[np.float64]

_RADIUS = "radius r (µm)"
_LEGEND_ABOVE = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"}


def velocity_against_radius(
    found: VelocityByRadius, *, title: str = "Vertical velocity against radius", caption: str = ""
) -> go.Figure:
    """Measured velocity along up (red) and Stokes velocity plus mean flow (blue) in bins of radius (Fig. 9)."""
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text=_RADIUS)
    figure.update_yaxes(title_text="velocity along up (µm/s)")
    figure.update_layout(legend=_LEGEND_ABOVE)
    known = found.measured.n > 0
    if not known.any():
        return say_empty(figure, "no trajectories")
    x = found.measured.x[known]
    figure.add_scatter(
        x=x,
        y=found.measured.mean[known],
        error_y={"array": np.nan_to_num(found.measured.standard_error[known])},
        error_x={"array": np.nan_to_num(found.radius_std_um[known])},
        mode="markers",
        marker={"color": VERMILION, "size": 7},
        name="measured",
        customdata=found.measured.n[known],
        hovertemplate="r %{x:.3g} µm<br>%{y:.3g} µm/s<br>%{customdata} trajectories<extra></extra>",
    )
    figure.add_scatter(
        x=x,
        y=found.expected_um_s[known],
        mode="lines+markers",
        marker={"color": BLUE, "symbol": "diamond", "size": 6},
        line={"color": BLUE, "width": 1},
        name=f"Stokes + mean flow ({found.flow_um_s:.2g} µm/s)",
    )
    return figure


def trajectory_lengths(
    found: TrajectoryLengths, *, title: str = "Length of trajectories against radius", caption: str = ""
) -> go.Figure:
    """Trajectories counted by radius and duration (log colours), their mean (squares) and the bound (red), Fig. 10."""
    figure = new_figure(title, caption)
    factor, unit = time_axis(found.duration_edges_s)
    figure.update_xaxes(title_text=_RADIUS, range=found.radius_edges_um[[0, -1]].tolist())
    figure.update_yaxes(title_text=f"duration ({unit})", range=[0, float(found.duration_edges_s[-1]) * factor])
    figure.update_layout(legend=_LEGEND_ABOVE)
    if not found.counts.any():
        return say_empty(figure, "no trajectories")
    log_counts = np.log10(np.where(found.counts > 0, found.counts, np.nan))
    figure.add_heatmap(
        x=found.radius_edges_um,
        y=found.duration_edges_s * factor,
        z=log_counts.T.astype(np.float32),
        colorscale=SEQUENTIAL,
        colorbar=log_colour_bar("trajectories", 0.0, float(np.nanmax(log_counts))),
        hovertemplate="r %{x:.3g} µm<br>%{y:.3g} " + unit + "<br>10^%{z:.2f}<extra></extra>",
    )
    known = found.mean_s.n > 0
    figure.add_scatter(
        x=found.mean_s.x[known],
        y=found.mean_s.mean[known] * factor,
        error_y={"array": np.nan_to_num(found.mean_s.standard_error[known]) * factor},
        mode="markers",
        marker={"color": BLACK, "symbol": "square", "size": 7, "line": {"color": "white", "width": 1}},
        name="mean",
    )
    centres = np.sqrt(found.radius_edges_um[1:] * found.radius_edges_um[:-1])
    bound = {"color": VERMILION, "width": 2}
    figure.add_scatter(x=centres, y=found.bound_s * factor, mode="lines", line=bound, name="H / u<sub>sed</sub>")
    return figure


def observed_depth(
    found: ObservedDepth, mean: BinnedMean, *, title: str = "Depth in which droplets are seen", caption: str = ""
) -> go.Figure:
    """Depth of each radius bin and the line through the origin (section 4.3)."""
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text=_RADIUS, rangemode="tozero")
    figure.update_yaxes(title_text="depth (µm)", rangemode="tozero")
    known = np.isfinite(found.depth_um)
    if not known.any() or not np.isfinite(found.per_radius):
        return say_empty(figure, "too few trajectories to tell the depth")
    x = mean.x[known]
    figure.add_scatter(x=x, y=found.depth_um[known], mode="markers", marker={"color": VERMILION}, name="from durations")
    ends = np.array([0.0, float(x.max())])
    name = f"({found.per_radius:.2f} ± {found.per_radius_std:.2f}) r"
    figure.add_scatter(x=ends, y=found.per_radius * ends, mode="lines", line={"color": BLUE}, name=name)
    return figure.update_layout(legend=_LEGEND_ABOVE)


def radius_scatter(
    found: RadiusScatter, *, title: str = "Scatter of the radius within trajectories", caption: str = ""
) -> go.Figure:
    """Mean standard deviation of the radius in trajectories, with its straight and its constant part (Fig. 11)."""
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text=_RADIUS, rangemode="tozero")
    figure.update_yaxes(title_text="standard deviation of r (µm)", rangemode="tozero")
    known = found.scatter.n > 0
    if not known.any():
        return say_empty(figure, "no trajectory is long enough")
    _add_points(figure, found.scatter, known, "mean scatter")
    if np.isfinite(found.relative):
        ends = np.array([0.0, found.break_um, float(found.scatter.x[known].max())])
        pieces = found.relative * np.minimum(ends, found.break_um)
        name = f"{100 * found.relative:.2g} % up to {found.break_um:.3g} µm"
        figure.add_scatter(x=ends, y=pieces, mode="lines", line={"color": BLUE}, name=name)
    return figure.update_layout(legend=_LEGEND_ABOVE)


def growth(
    found: Growth,
    *,
    swept_um_s: Floats | None = None,
    title: str = "Growth of droplets against radius",
    caption: str = "",
) -> go.Figure:
    """Mean dr/dt of single droplets; with `swept_um_s`, what collision efficiency 1 would give (section 5)."""
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text=_RADIUS)
    figure.update_yaxes(title_text="growth dr/dt (µm/s)")
    figure.add_hline(y=0, line={"color": "#999", "width": 1})
    known = found.rate.n > 1
    if not known.any():
        return say_empty(figure, "no trajectory is long enough")
    _add_points(figure, found.rate, known, "measured")
    if swept_um_s is not None:
        figure.add_scatter(
            x=found.rate.x[known],
            y=swept_um_s[known],
            mode="lines",
            line={"color": ORANGE, "dash": "dash"},
            name="collision efficiency 1",
        )
    return figure.update_layout(legend=_LEGEND_ABOVE)


def _add_points(figure: go.Figure, found: BinnedMean, known: npt.NDArray[np.bool_], name: str) -> None:
    figure.add_scatter(
        x=found.x[known],
        y=found.mean[known],
        error_y={"array": np.nan_to_num(found.standard_error[known])},
        mode="markers",
        marker={"color": VERMILION, "size": 7},
        name=name,
        customdata=found.n[known],
        hovertemplate="r %{x:.3g} µm<br>%{y:.3g}<br>%{customdata} trajectories<extra></extra>",
    )
