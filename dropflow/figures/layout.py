"""How every figure looks: fit to print, one font, colours that colour-blind readers can tell apart."""

import math
from collections.abc import Mapping, Sequence
from textwrap import wrap
from typing import Any

import plotly.graph_objects as go

SEQUENTIAL = "Viridis"
DIVERGING = "RdBu"
# Okabe and Ito's colours: told apart with every common kind of colour vision.
BLUE, ORANGE, GREEN, VERMILION, PURPLE, SKY, BLACK = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#D55E00",
    "#CC79A7",
    "#56B4E9",
    "#000000",
)
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)

COLOURS_OF_RUNS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, "#7D7D7D", "#B8A800")
"""Of analyses beside each other; on the pages of the service a run of number n has the colour n - 1."""

WIDTH_PX, HEIGHT_PX = 760, 520
MAX_COLUMNS = 600
"""Columns of a heat map over time: more than a printed figure or a screen can show."""

_CAPTION_CHARACTERS = 118
_CAPTION_LINE_PX = 15


def new_figure(title: str, caption: str = "", *, width_px: int = WIDTH_PX, height_px: int = HEIGHT_PX) -> go.Figure:
    """An empty figure with the common look; `caption` stands below the axes."""
    lines = wrap(caption, _CAPTION_CHARACTERS, break_on_hyphens=False)
    bottom_px = 70 + _CAPTION_LINE_PX * len(lines)
    figure = go.Figure(
        layout={
            # At the very top: a wide legend stands between it and the axes.
            "title": {"text": title, "x": 0.02, "y": 1, "yanchor": "top", "pad": {"t": 10}, "font": {"size": 15}},
            "width": width_px,
            "height": height_px + _CAPTION_LINE_PX * len(lines),
            "font": {"family": "Helvetica, Arial, sans-serif", "size": 13, "color": "#000000"},
            "paper_bgcolor": "white",
            "plot_bgcolor": "white",
            "colorway": list(COLOURS),
            "margin": {"l": 75, "r": 30, "t": 66, "b": bottom_px},
            "legend": {"bgcolor": "rgba(255,255,255,0.8)", "bordercolor": "#999", "borderwidth": 1},
        }
    )
    figure.update_xaxes(**_axis())
    figure.update_yaxes(**_axis())
    if lines:
        figure.add_annotation(
            text="<br>".join(lines),
            x=0,
            y=0,
            xref="paper",
            yref="paper",
            yshift=-50,
            yanchor="top",
            xanchor="left",
            align="left",
            showarrow=False,
            font={"size": 11, "color": "#333"},
        )
    return figure


def _axis() -> dict[str, Any]:
    return {
        "showline": True,
        "mirror": True,
        "linecolor": "black",
        "ticks": "inside",
        "tickcolor": "black",
        "showgrid": False,
        "zeroline": False,
        "automargin": False,
    }


def stacked_axes(figure: go.Figure, titles: Sequence[str]) -> go.Figure:
    """Stack one y axis a title over one x axis, the first at the bottom, so that a brushed range of x holds for all."""
    gap = 0.08
    height = (1 - gap * (len(titles) - 1)) / len(titles)
    look = figure.layout.yaxis.to_plotly_json()
    for number, title in enumerate(titles):
        low = number * (height + gap)
        place = {"title": {"text": title}, "domain": [low, min(low + height, 1)], "anchor": "x"}
        figure.update_layout({f"yaxis{number + 1 if number else ''}": {**look, **place, "rangemode": "tozero"}})
    return figure.update_layout(xaxis={"anchor": "y", "mirror": "all"})


def say_empty(figure: go.Figure, what: str) -> go.Figure:
    """Write across an empty figure why nothing is drawn; axes without data have no numbers."""
    for axis in figure.select_xaxes():
        axis.showticklabels = axis.range is not None
    for axis in figure.select_yaxes():
        axis.showticklabels = axis.range is not None
    figure.add_annotation(text=what, x=0.5, y=0.5, xref="paper", yref="paper", showarrow=False, font={"size": 16})
    return figure


def log_colour_bar(title: str, low: float, high: float) -> dict[str, Any]:
    """A colour bar for values drawn as their decadic logarithm, between log10 `low` and log10 `high`."""
    first, last = int(low // 1), int(-(-high // 1))
    exponents = list(range(first, last + 1, max(1, (last - first) // 8)))
    ticks = {float(exponent): f"10<sup>{exponent}</sup>".replace("-", "−") for exponent in exponents}
    if last - first <= 2:  # within so little there may be no power of ten
        ticks |= {exponent + math.log10(part): str(part) for exponent in exponents for part in (2, 5)}
    return {
        "title": {"text": title, "side": "right"},
        "tickvals": list(ticks),
        "ticktext": list(ticks.values()),
        "outlinewidth": 1,
        "ticks": "inside",
    }


def caption_of(provenance: Mapping[str, Any]) -> str:
    """Where a figure comes from, in one line: ``experiment: a · method: paper · dropflow: 0.1.0``."""
    return " · ".join(f"{name}: {value}" for name, value in provenance.items() if value not in (None, ""))


def with_error(value: float, std: float = math.nan, unit: str = "") -> str:
    """A number for people with as many digits as its error allows, ``(−2.46 ± 0.06)·10⁴ s/m²``; NaN is "not known"."""
    if not math.isfinite(value):
        return "not known"
    size = math.floor(math.log10(abs(value))) if value else 0
    power = size if size >= 4 or size <= -3 else 0
    scale = 10.0**-power
    if math.isfinite(std) and std > 0:
        n_decimals = max(0, 1 - math.floor(math.log10(std * scale)))
        text = f"{value * scale:.{n_decimals}f} ± {std * scale:.{n_decimals}f}"
        text = f"({text})" if power else text
    else:
        text = f"{value * scale:.4g}"
    if power:
        text += f"·10{str(power).translate(_SUPERSCRIPT)}"
    return f"{text} {unit}".strip().replace("-", "−")


_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def time_axis(times_s: Any) -> tuple[float, str]:
    """Factor and unit in which a time axis of this length reads well: seconds, minutes or hours."""
    longest_s = float(max(times_s, default=0.0))
    if longest_s <= 600:
        return 1.0, "s"
    return (1 / 60, "min") if longest_s <= 4 * 3600 else (1 / 3600, "h")
