"""Rates of coalescence by the sizes of both partners (section 5)."""

import numpy as np
import plotly.graph_objects as go

from dropflow.figures.layout import SEQUENTIAL, log_colour_bar, new_figure, say_empty
from dropflow.statistics.coalescence import CoalescenceRates


def coalescence(found: CoalescenceRates, *, title: str = "Coalescence by size pair", caption: str = "") -> go.Figure:
    """Events per area and time on a decadic logarithmic colour scale; the number of events stands in each bin."""
    figure = new_figure(title, caption)
    range_um = np.log10(found.edges_um[[0, -1]]).tolist()
    figure.update_xaxes(title_text="radius of the larger (µm)", type="log", range=range_um)
    figure.update_yaxes(title_text="radius of the smaller (µm)", type="log", range=range_um)
    if not found.counts.any():
        return say_empty(figure, "no coalescence was seen")
    log_rate = np.log10(np.where(found.counts > 0, found.rate_per_um2_s * 1e6, np.nan))
    low, high = float(np.nanmin(log_rate)), float(np.nanmax(log_rate))
    return figure.add_heatmap(
        x=found.edges_um,
        y=found.edges_um,
        z=log_rate.astype(np.float32),
        zmin=low,
        zmax=max(high, low + 0.1),
        text=np.where(found.counts > 0, found.counts.astype(str), ""),
        texttemplate="%{text}",
        colorscale=SEQUENTIAL,
        colorbar=log_colour_bar("events (mm<sup>−2</sup> s<sup>−1</sup>)", low, high),
    )
