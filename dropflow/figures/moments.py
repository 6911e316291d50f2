"""Number, mean radius, Sauter radius, fraction and percentiles of the droplets over time."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import (
    BLUE,
    GREEN,
    MAX_COLUMNS,
    SKY,
    VERMILION,
    new_figure,
    say_empty,
    stacked_axes,
    time_axis,
)
from dropflow.statistics.histograms import FrameHistograms, coarsen
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.size_distribution import PERCENTILES, size_moments

Floats = npt.NDArray[np.float64]


def moments(
    histograms: FrameHistograms,
    *,
    area_um2: float,
    observation_depth_um: float | Floats | None = None,
    seen: InSight | None = None,
    title: str = "Moments of the size distribution",
    caption: str = "",
    max_columns: int = MAX_COLUMNS,
) -> go.Figure:
    """Three panels over time: droplets per frame, radii (mean, Sauter, percentiles) and volume or area fraction.

    Bands are one standard deviation; with `seen`, a droplet that is seen in several frames counts as one.
    """
    figure = new_figure(title, caption, height_px=760)
    shown = coarsen(histograms, max_columns)
    found = size_moments(shown, area_um2=area_um2, observation_depth_um=observation_depth_um, seen=seen)
    factor, unit = time_axis(shown.time_s)
    breaks = np.flatnonzero(shown.first_frame[1:] > shown.last_frame[:-1] + 1) + 1
    lines = _Lines(figure, shown.time_s * factor, breaks)
    fraction = "volume fraction" if found.is_volume_fraction else "area fraction"
    stacked_axes(figure, [fraction, "radius (µm)", "droplets per frame"])
    figure.update_layout(
        xaxis={"title": {"text": f"time t ({unit})"}},
        legend={"x": 1.01, "y": 0.5, "xanchor": "left"},
        margin={"r": 190},
    )
    if not len(shown) or not shown.moments[:, 0].any():
        return say_empty(figure, "no droplets")
    lines.add(found.n_per_frame, found.n_per_frame_std, "number", BLUE, "y3")
    lines.add(found.mean_radius_um, found.mean_radius_std_um, "mean radius", BLUE, "y2")
    lines.add(found.sauter_radius_um, found.sauter_radius_std_um, "Sauter radius d32/2", VERMILION, "y2")
    for percent, radius_um in zip(PERCENTILES, found.percentiles_um.T, strict=True):
        name = f"{percent:.0f} % are smaller"
        line = {"color": SKY, "width": 1, "dash": "dash" if percent == 50 else "dot"}
        lines.draw(radius_um, "y2", name=name, line=line)
    lines.add(found.fraction, found.fraction_std, fraction, GREEN, "y")
    return figure


@dataclass(frozen=True)
class _Lines:
    """Draws lines over one time axis that break where frames are missing."""

    figure: go.Figure
    time: Floats
    breaks: npt.NDArray[np.int64]

    def draw(self, values: Floats, axis: str, **look: Any) -> None:
        """One line; a point where there is but one frame, of which no line shows."""
        mode = "lines" if len(self.time) > 1 else "markers"
        x, y = (np.insert(of.astype(np.float32), self.breaks, np.nan) for of in (self.time, values))
        self.figure.add_scatter(x=x, y=y, yaxis=axis, mode=mode, **look)

    def add(self, value: Floats, std: Floats, name: str, colour: str, axis: str) -> None:
        """A line with a shaded band of one standard deviation."""
        x, y = _outlines(self.time, value, std, self.breaks)
        band = {"fill": "toself", "fillcolor": _faint(colour), "showlegend": False, "hoverinfo": "skip"}
        self.figure.add_scatter(x=x, y=y, yaxis=axis, mode="lines", line={"width": 0}, **band)
        self.draw(value, axis, name=name, line={"color": colour, "width": 1.5})


def _outlines(
    time: Floats, value: Floats, std: Floats, breaks: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Closed outlines of a band, one for each run of values without a gap, parted by NaN."""
    is_known = np.isfinite(value + std)
    changes = np.flatnonzero(is_known[1:] != is_known[:-1]) + 1
    nothing = np.array([np.nan])
    x, y = [np.empty(0)], [np.empty(0)]
    for run in np.split(np.arange(len(time)), np.union1d(breaks, changes)):
        if is_known[run].any():
            x += [time[run], time[run][::-1], nothing]
            y += [(value + std)[run], (value - std)[run][::-1], nothing]
    return np.concatenate(x).astype(np.float32), np.concatenate(y).astype(np.float32)


def _faint(colour: str) -> str:
    red, green, blue = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.25)"
