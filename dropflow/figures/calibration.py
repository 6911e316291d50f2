"""Velocity against r^2 among neighbours, from which the fluids' density difference over viscosity follows (eq. 4)."""

import numpy as np
import plotly.graph_objects as go

from dropflow.figures.layout import BLUE, ORANGE, VERMILION, new_figure, say_empty, with_error
from dropflow.statistics.calibration import Calibration


def self_calibration(
    found: Calibration, *, title: str = "Velocity against r² among neighbours", caption: str = ""
) -> go.Figure:
    """Measured points, the fitted line, and the line of the material."""
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text="r² minus that of the neighbours (µm²)")
    figure.update_yaxes(title_text="velocity along up minus that of the neighbours (µm/s)")
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"})
    if not np.isfinite(found.density_over_viscosity_s_m2) or not len(found.r2_um2):
        return say_empty(figure, "too few droplets have neighbours")
    figure.add_scatter(
        x=found.r2_um2,
        y=found.along_um_s,
        error_y={"array": found.along_std_um_s},
        mode="markers",
        marker={"color": VERMILION, "size": 7},
        name="measured",
    )
    ends = np.array([found.r2_um2.min(), found.r2_um2.max()])
    measured = f"Δρ/η = {with_error(found.density_over_viscosity_s_m2, found.std_s_m2, 's/m²')}"
    for value, name, colour, dash in (
        (found.density_over_viscosity_s_m2, measured, BLUE, "solid"),
        (found.expected_s_m2, f"material: {with_error(found.expected_s_m2, unit='s/m²')}", ORANGE, "dash"),
    ):
        line = {"color": colour, "dash": dash}
        figure.add_scatter(x=ends, y=found.slope_per_um_s(value) * ends, mode="lines", line=line, name=name)
    return figure
