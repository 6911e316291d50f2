"""Collision efficiency: measured growth over that of droplets that take up all in their way (section 5)."""

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import VERMILION, new_figure, say_empty
from dropflow.statistics.growth import Growth
from dropflow.statistics.growth import collision_efficiency as efficiency_of

Floats = npt.NDArray[np.float64]

_WIDE = 100.0
"""Ratio of the largest to the smallest value from which the axis is logarithmic."""


def collision_efficiency(
    found: Growth,
    swept_um_s: Floats | None,
    *,
    title: str = "Collision efficiency against radius",
    caption: str = "",
) -> go.Figure:
    """Share of the smaller droplets in its way that a droplet takes up; an upper bound, for it grows by diffusion, too.

    Parameters
    ----------
    found
        Measured growth.
    swept_um_s
        Growth at efficiency 1 in the same bins; None where the observed depth is unknown.
    """
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text="radius r (µm)")
    figure.update_yaxes(title_text="collision efficiency", rangemode="tozero")
    if swept_um_s is None:
        return say_empty(figure, "the observed depth is unknown: give observation_depth_um")
    share, error = efficiency_of(found, swept_um_s)
    known = np.isfinite(share) & np.isfinite(error)
    if not known.any():
        return say_empty(figure, "no trajectory is long enough")
    positive = known & (share > 0)
    if positive.any() and share[positive].max() > _WIDE * share[positive].min():
        figure.update_yaxes(type="log", exponentformat="power")
        if (n_left_out := int((known & ~positive).sum())) > 0:
            text = f"{n_left_out} bin{'s' if n_left_out > 1 else ''} without growth left out"
            place = {"x": 1, "y": 1, "xref": "paper", "yref": "paper", "xanchor": "right", "yanchor": "bottom"}
            figure.add_annotation(text=text, showarrow=False, **place)
        known = positive
    figure.add_hline(y=1, line={"color": "#999", "dash": "dash", "width": 1})
    return figure.add_scatter(
        x=found.rate.x[known],
        y=share[known],
        error_y={"array": error[known]},
        mode="markers",
        marker={"color": VERMILION, "size": 7},
        customdata=found.rate.n[known],
        hovertemplate="r %{x:.3g} µm<br>%{y:.3g}<br>%{customdata} trajectories<extra></extra>",
        showlegend=False,
    )
