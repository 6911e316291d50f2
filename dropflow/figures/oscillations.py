"""The oscillating signal with its peaks, its periods, and periods against the driving (section 4.7, Fig. 15)."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.layout import BLACK, BLUE, GREEN, PURPLE, SKY, VERMILION, new_figure, say_empty, time_axis
from dropflow.statistics.oscillations import (
    LATER_THEORY_EXPONENT,
    Oscillations,
    PeriodLaw,
    Signal,
    driving_group,
    period_law,
)

Floats = npt.NDArray[np.float64]

_GROUPS = (
    ("ξ < 6·10⁻⁶", BLACK, "star"),
    ("ξ < 1.3·10⁻⁵", BLUE, "cross"),
    ("ξ < 3·10⁻⁵", SKY, "circle"),
    ("ξ < 6·10⁻⁵", GREEN, "triangle-up"),
    ("ξ < 3·10⁻⁴", VERMILION, "square"),
    ("ξ > 3·10⁻⁴", PURPLE, "diamond"),
)
"""Name, colour and symbol of each group of Fig. 15."""


_SIGNALS = {
    Signal.N_DROPLETS: "number of droplets",
    Signal.N_SMALL: "number of small droplets",
    Signal.MEAN_RADIUS: "mean radius",
    Signal.SAUTER_RADIUS: "Sauter radius",
}


def oscillating_signal(found: Oscillations, *, title: str = "Oscillations", caption: str = "") -> go.Figure:
    """The signal's relative deviation from its trend, with certain peaks filled and uncertain ones open."""
    figure = new_figure(title, caption, height_px=420)
    factor, unit = time_axis(found.time_s)
    figure.update_xaxes(title_text=f"time t ({unit})")
    figure.update_yaxes(title_text=f"{_SIGNALS[found.signal_name]} over its trend − 1")
    if not len(found.peak_s):
        return say_empty(figure, "no oscillation stands out of the noise")
    figure.add_scatter(
        x=(found.time_s * factor).astype(np.float32),
        y=found.signal.astype(np.float32),
        mode="lines",
        line={"color": BLUE, "width": 1},
        name="signal",
    )
    at = np.interp(found.peak_s, found.time_s, found.signal)
    for is_certain, name, symbol in ((True, "peak", "circle"), (False, "uncertain peak", "circle-open")):
        which = found.is_certain == is_certain
        if which.any():
            figure.add_scatter(
                x=found.peak_s[which] * factor,
                y=at[which],
                error_x={"array": found.peak_std_s[which] * factor},
                mode="markers",
                marker={"symbol": symbol, "size": 9, "color": VERMILION},
                name=name,
            )
    return figure


def periods(
    found: Oscillations, *, temperature_c: Floats | None = None, title: str = "Periods", caption: str = ""
) -> go.Figure:
    """Time from each peak to the next, against time, or against temperature where it is known at each period."""
    figure = new_figure(title, caption, height_px=420)
    factor, unit = time_axis(found.period_at_s)
    if temperature_c is None:
        x, x_title = found.period_at_s * factor, f"time t ({unit})"
    else:
        x, x_title = temperature_c, "temperature T (°C)"
    figure.update_xaxes(title_text=x_title)
    period_factor, period_unit = time_axis(found.period_s)
    figure.update_yaxes(title_text=f"period Δt ({period_unit})", rangemode="tozero")
    if not len(found.period_s):
        return say_empty(figure, "fewer than two oscillations")
    for is_certain, name, symbol in ((True, "period", "circle"), (False, "uncertain", "circle-open")):
        which = found.is_period_certain == is_certain
        if which.any():
            figure.add_scatter(
                x=x[which],
                y=found.period_s[which] * period_factor,
                error_y={"array": found.period_std_s[which] * period_factor},
                mode="markers",
                marker={"symbol": symbol, "size": 8, "color": BLUE},
                name=name,
            )
    return figure


def periods_against_driving(
    experiments: Mapping[str, tuple[float, Floats]],
    *,
    law: PeriodLaw | None = None,
    title: str = "Period against driving",
    caption: str = "",
) -> go.Figure:
    """All periods of several experiments against their driving parameter, with the fitted power law (Fig. 15).

    `experiments` gives xi (1/s) and the periods (s) of each, `law` the fit where it was made already. The grey line
    has the exponent -3/7 of the field's later theory, through the middle of the data.
    """
    figure = new_figure(title, caption)
    figure.update_xaxes(title_text="driving parameter ξ (s<sup>−1</sup>)", type="log", exponentformat="power")
    figure.update_yaxes(title_text="period Δt (s)", type="log")
    driving = np.concatenate([np.full(len(all_s), xi) for xi, all_s in experiments.values()] or [np.empty(0)])
    period_s = np.concatenate([all_s for _, all_s in experiments.values()] or [np.empty(0)])
    if not len(driving):
        return say_empty(figure, "no experiment with a known ξ and two certain oscillations")
    group = driving_group(driving)
    for number in np.unique(group):
        name, colour, symbol = _GROUPS[number]
        which = group == number
        marker = {"color": colour, "symbol": symbol, "size": 8}
        figure.add_scatter(x=driving[which], y=period_s[which], mode="markers", marker=marker, name=f"{name} s⁻¹")
    law = law or period_law(driving, period_s)
    if np.isfinite(law.exponent):
        ends = np.array([driving.min(), driving.max()])
        error = f" ± {law.exponent_std:.2f}" if np.isfinite(law.exponent_std) else ""
        fit = law.prefactor_s * ends**law.exponent
        figure.add_scatter(
            x=ends,
            y=fit,
            mode="lines",
            line={"color": BLACK},
            name=f"exponent {law.exponent:.2f}{error}".replace("-", "−"),
        )
        middle_x, middle_y = np.exp(np.log(driving).mean()), np.exp(np.log(period_s).mean())
        theory = middle_y * (ends / middle_x) ** LATER_THEORY_EXPONENT
        line = {"color": "#999", "dash": "dash"}
        figure.add_scatter(x=ends, y=theory, mode="lines", line=line, name="exponent −3/7 (later theory)")
    return figure
