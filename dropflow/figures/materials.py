"""Phase diagram, viscosity and temperature ramp of a material (Figs. 1 and 16, eq. 2)."""

import numpy as np
import plotly.graph_objects as go

from dropflow.experiment import Phase
from dropflow.figures.layout import BLUE, GREEN, SKY, VERMILION, new_figure, time_axis
from dropflow.physics.binodal import TableBinodal
from dropflow.physics.material import MixtureProperties
from dropflow.physics.material_files import MaterialFile
from dropflow.physics.ramp import Ramp

_N_POINTS = 300
_LEGEND_ABOVE = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"}


def phase_diagram(material: MaterialFile, *, title: str = "Phase diagram", caption: str = "") -> go.Figure:
    """Compositions of both phases against temperature, with the measured points where there are any (Fig. 1)."""
    properties = MixtureProperties(material)
    binodal = properties.binodal
    low, high = binodal.range_c
    temperature_c = low + (high - low) * np.linspace(0, 1, _N_POINTS) ** 3
    figure = new_figure(title, _caption(material, caption))
    second = properties.mixture.second.name
    figure.update_xaxes(title_text=f"composition Φ (mass fraction of {second})", range=[0, 1])
    figure.update_yaxes(title_text="temperature T (°C)")
    for phase, composition, colour in zip(
        ("bottom", "top"), binodal.phases(temperature_c), (BLUE, VERMILION), strict=True
    ):
        line = {"color": colour, "width": 2}
        figure.add_scatter(x=composition, y=temperature_c, mode="lines", line=line, name=f"{phase} phase")
    if isinstance(binodal, TableBinodal):
        points = [(point.temperature_c, side) for point in binodal.points for side in (point.bottom, point.top)]
        y, x = zip(*points, strict=True)
        figure.add_scatter(x=x, y=y, mode="markers", marker={"color": "black", "symbol": "x"}, name="measured")
    return figure.update_layout(legend=_LEGEND_ABOVE)


def viscosity(
    material: MaterialFile,
    *,
    from_c: float = 25.0,
    to_c: float = 50.0,
    title: str = "Viscosity against temperature",
    caption: str = "",
) -> go.Figure:
    """Viscosity of both phases and both pure fluids (Fig. 16)."""
    properties = MixtureProperties(material)
    mixture, binodal = properties.mixture, properties.binodal
    figure = new_figure(title, _caption(material, caption))
    figure.update_xaxes(title_text="temperature T (°C)")
    figure.update_yaxes(title_text="viscosity η (mPa s)", rangemode="tozero")
    temperature_c = np.linspace(from_c, to_c, _N_POINTS)
    two_phase_c = temperature_c[(temperature_c >= binodal.range_c[0]) & (temperature_c <= binodal.range_c[1])]
    compositions = dict(zip((Phase.BOTTOM, Phase.TOP), binodal.phases(two_phase_c), strict=True))
    curves = [
        (f"{phase} phase", two_phase_c, properties.viscosity_pa_s(compositions[phase], two_phase_c), colour, "solid")
        for phase, colour in ((Phase.TOP, VERMILION), (Phase.BOTTOM, BLUE))
    ]
    for fluid, colour in ((mixture.second, GREEN), (mixture.first, SKY)):
        if fluid.viscosity is not None:
            curves.append((fluid.name, temperature_c, fluid.viscosity.at(temperature_c), colour, "dash"))
    for name, t, value, colour, dash in curves:
        figure.add_scatter(x=t, y=value * 1e3, mode="lines", line={"color": colour, "dash": dash}, name=name)
    return figure.update_layout(legend=_LEGEND_ABOVE)


def temperature_ramp(
    ramp: Ramp, material: MaterialFile, *, title: str = "Temperature ramp", caption: str = ""
) -> go.Figure:
    """Temperature over time for a constant driving parameter (eq. 2)."""
    figure = new_figure(title, _caption(material, f"ξ = {ramp.driving_per_s:.3g} s⁻¹. {caption}"))
    factor, unit = time_axis(ramp.time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text="temperature T (°C)")
    few = np.linspace(0, len(ramp.time_s) - 1, _N_POINTS).round().astype(np.int64)
    line = {"color": BLUE, "width": 2}
    figure.add_scatter(
        x=ramp.time_s[few] * factor, y=ramp.temperature_c[few], mode="lines", line=line, showlegend=False
    )
    return figure


def _caption(material: MaterialFile, more: str) -> str:
    """Every figure of a material names it, and says where its numbers are not measured."""
    return f"Material: {material.label}. {more}".strip()
