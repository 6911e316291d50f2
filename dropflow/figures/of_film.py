"""How each figure is drawn from the findings of a film, and of which films it cannot be drawn."""

from typing import Any

import plotly.graph_objects as go

from dropflow import figures
from dropflow.figures.entry import Draw
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings


def sizes(found: Findings) -> dict[str, Any]:
    return {"area_um2": found.facts.area_um2, "observation_depth_um": found.depth_um}


def before(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution(found.before, **sizes(found), **said)


def after(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution(found.after, **sizes(found), **said)


def range_of_times(found: Findings, **said: Any) -> go.Figure:
    return figures.size_distribution_at(found.before, found.after, **sizes(found), seen=found.seen, **said)


def moments(found: Findings, **said: Any) -> go.Figure:
    return figures.moments(found.shown_sizes, **sizes(found), seen=found.seen, **said)


def of_part(draw_part: Draw, part: str) -> Draw:
    """A figure that takes one part of the findings and nothing else."""

    def drawn(found: Findings, **said: Any) -> go.Figure:
        return draw_part(getattr(found, part), **said)

    return drawn


def depth(found: Findings, **said: Any) -> go.Figure:
    return figures.observed_depth(found.depth, found.whole_lengths.mean_s, **said)


def growth(found: Findings, **said: Any) -> go.Figure:
    return figures.growth(found.growth, swept_um_s=found.swept_um_s, **said)


def efficiency(found: Findings, **said: Any) -> go.Figure:
    return figures.collision_efficiency(found.growth, found.swept_um_s, **said)


def flow_steps(found: Findings, **said: Any) -> go.Figure:
    shown = found.shown_flow
    return figures.flow_moments(shown.time_s, shown.mean_um_s, shown.rms_um_s, **said)


def flow_bins(found: Findings, **said: Any) -> go.Figure:
    of = found.binned_flow
    errors: dict[str, Any] = {"mean_std_um_s": of.mean_std_um_s, "rms_std_um_s": of.rms_std_um_s}
    return figures.flow_moments(of.time_s, of.mean_um_s, of.rms_um_s, **errors, **said)


def periods(found: Findings, **said: Any) -> go.Figure:
    of, temperature = found.oscillations, found.temperature
    at_c = temperature.at(of.period_at_s) if temperature is not None and len(of.period_at_s) else None
    return figures.periods(of, temperature_c=at_c, **said)


def of_mixture(draw_material: Draw) -> Draw:
    def drawn(found: Findings, **said: Any) -> go.Figure:
        return draw_material(found.facts.mixture, **said)

    return drawn


def no_mixture(facts: FilmFacts) -> str | None:
    return None if facts.mixture else "The experiment's material is no mixture: its numbers are fixed."


def no_log(facts: FilmFacts) -> str | None:
    return None if facts.experiment.temperature_log else "The experiment has no temperature log."


def no_driving(facts: FilmFacts) -> str | None:
    return no_mixture(facts) or no_log(facts)
