"""Correlation of the flow over distance and time (section 3.2.2)."""

import numpy as np
import plotly.graph_objects as go

from dropflow.figures.layout import BLUE, new_figure, say_empty, with_error
from dropflow.statistics.flow_correlation import FlowCorrelation


def flow_correlation(found: FlowCorrelation, *, title: str = "Correlation of the flow", caption: str = "") -> go.Figure:
    """Correlation against distance (left) and against time (right), with the places where it falls below 1 / e."""
    figure = new_figure(title, caption, height_px=420)
    axis = figure.layout.yaxis.to_plotly_json()
    figure.update_layout(
        xaxis={"domain": [0, 0.45], "title": {"text": "distance (µm)"}},
        yaxis={"title": {"text": "correlation"}, "range": [-0.5, 1.05]},
        xaxis2={
            **figure.layout.xaxis.to_plotly_json(),
            "domain": [0.55, 1],
            "title": {"text": "time (s)"},
            "anchor": "y2",
        },
        yaxis2={**axis, "anchor": "x2", "range": [-0.5, 1.05], "title": {"text": ""}},
        showlegend=False,
    )
    if not np.isfinite(found.in_space).any():
        return say_empty(figure, "no flow")
    line = {"color": BLUE, "width": 1.5}
    figure.add_scatter(x=found.distance_um, y=found.in_space, mode="lines+markers", line=line, marker={"size": 5})
    shown = slice(0, _shown_lags(found))
    figure.add_scatter(x=found.lag_s[shown], y=found.in_time[shown], mode="lines", line=line, xaxis="x2", yaxis="y2")
    for value, std, axis_id, unit in (
        (found.length_um, found.length_std_um, "x", "µm"),
        (found.time_s, found.time_std_s, "x2", "s"),
    ):
        if np.isfinite(value):
            figure.add_vline(x=value, line={"color": "#999", "dash": "dash"}, col=None, xref=axis_id)
            figure.add_annotation(
                x=value,
                y=0.97,
                xref=axis_id,
                yref="paper",
                text=with_error(value, std, unit),
                showarrow=False,
                xanchor="left",
                xshift=4,
            )
    return figure


def _shown_lags(found: FlowCorrelation) -> int:
    """Ten correlation times, or all lags where there is no such time."""
    if not np.isfinite(found.time_s) or len(found.lag_s) < 2:
        return min(len(found.lag_s), 600)
    return min(len(found.lag_s), max(10, int(10 * found.time_s / (found.lag_s[1] - found.lag_s[0]))), 2000)
