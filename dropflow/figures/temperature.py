"""Temperature and driving parameter over the film (section 2.3, eq. 1)."""

import numpy as np
import plotly.graph_objects as go

from dropflow.figures.layout import BLUE, VERMILION, new_figure, say_empty, time_axis
from dropflow.physics.temperature_log import Driving, TemperatureLog

_MOST_POINTS = 1000


def temperature(found: TemperatureLog, *, title: str = "Temperature over time", caption: str = "") -> go.Figure:
    """The logged temperature at the times of the frames."""
    figure = new_figure(title, caption, height_px=420)
    factor, unit = time_axis(found.time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text="temperature T (°C)")
    if not len(found.time_s):
        return say_empty(figure, "no frame lies in this range")
    shown = np.unique(np.linspace(0, len(found.time_s) - 1, _MOST_POINTS).round().astype(np.int64))
    return figure.add_scatter(
        x=found.time_s[shown] * factor, y=found.temperature_c[shown], mode="lines", line={"color": BLUE}, name="T"
    )


def driving(found: Driving, *, title: str = "Driving parameter over time", caption: str = "") -> go.Figure:
    """The driving parameter xi in windows of time, with standard errors, and its mean."""
    figure = new_figure(title, caption, height_px=420)
    factor, unit = time_axis(found.time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text="driving parameter ξ (s<sup>−1</sup>)", exponentformat="power")
    if not len(found.time_s):
        return say_empty(figure, "the temperature log has too few entries in the two-phase region")
    figure.add_scatter(
        x=found.time_s * factor,
        y=found.driving_per_s,
        error_y={"array": np.nan_to_num(found.driving_std_per_s, posinf=0.0)},
        mode="markers",
        marker={"color": VERMILION, "size": 7},
        name="in windows",
    )
    mean = float(found.driving_per_s.mean())
    return figure.add_hline(y=mean, line={"color": BLUE}, annotation_text=f"mean {mean:.3g} s⁻¹")
