"""Mean and root-mean-square of both flow components over time (Fig. 14)."""

from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import BLUE, VERMILION, new_figure, say_empty, time_axis

Floats = npt.NDArray[np.floating[Any]]


def flow_moments(
    time_s: Floats,
    mean_um_s: Floats,
    rms_um_s: Floats,
    *,
    mean_std_um_s: Floats | None = None,
    rms_std_um_s: Floats | None = None,
    title: str = "Flow over time",
    caption: str = "",
) -> go.Figure:
    """Mean (circles) and rms (triangles) of the horizontal (red) and upward (blue) flow (Fig. 14).

    Parameters
    ----------
    time_s
        Shape (n,).
    mean_um_s, rms_um_s
        Shape (n, 2): horizontal, upward. NaN where no cell was computed from droplets.
    mean_std_um_s, rms_std_um_s
        Their standard errors, same shape; drawn as error bars.
    """
    figure = new_figure(title, caption)
    factor, unit = time_axis(time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text="flow velocity (µm/s), upward positive")
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"})
    if not np.isfinite(mean_um_s).any():
        return say_empty(figure, "no flow: no droplet was followed")
    figure.add_hline(y=0, line={"color": "#999", "width": 1})
    mode = "lines+markers" if len(time_s) <= 120 else "lines"
    for values, stds, symbol, dash, what in (
        (mean_um_s, mean_std_um_s, "circle", "solid", "mean"),
        (rms_um_s, rms_std_um_s, "triangle-up", "dot", "rms"),
    ):
        for component, (direction, colour) in enumerate((("horizontal", VERMILION), ("vertical", BLUE))):
            error = (
                None if stds is None else {"array": stds[:, component].astype(np.float32), "width": 2, "thickness": 1}
            )
            figure.add_scatter(
                x=(time_s * factor).astype(np.float32),
                y=values[:, component].astype(np.float32),
                error_y=error,
                mode=mode,
                marker={"symbol": symbol, "size": 7},
                line={"color": colour, "dash": dash, "width": 1},
                name=f"{what} {direction}",
            )
    return figure
