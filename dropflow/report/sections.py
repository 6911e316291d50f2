"""The figures of a report, in the order of the paper, each with how it was computed."""

from dataclasses import dataclass

import plotly.graph_objects as go

from dropflow.figures.catalogue import CATALOGUE
from dropflow.figures.entry import Entry, Group, draw
from dropflow.report.frames import FrameSource, draw_of_frame
from dropflow.statistics.findings import Findings


@dataclass(frozen=True)
class Section:
    """One figure and what to say of it."""

    key: str
    """Its name in the catalogue."""
    figure: go.Figure
    how: str
    """How it was computed, in a sentence or two, and where the paper has it."""


def sections(found: Findings, source: FrameSource) -> list[Section]:
    """All figures of an analysis; one without data says so and is drawn empty."""
    made = []
    for entry in CATALOGUE:
        if _missing(entry, found):
            continue
        figure = draw(entry, found) if entry.drawing.draw else draw_of_frame(entry, found, source)
        if figure is not None:
            made.append(Section(entry.name, figure, f"{_how(entry, found)} ({entry.paper})"))
    return made


def _missing(entry: Entry, found: Findings) -> bool:
    """A log given to the report counts though the experiment names none."""
    if entry.name == "temperature":
        return found.temperature is None
    if entry.name == "driving":
        return found.driving is None
    return entry.drawing.missing(found.facts) is not None


def _how(entry: Entry, found: Findings) -> str:
    if entry.group is not Group.SIZES:
        return entry.how
    return f"{entry.how} {_depth_words(found)}"


def _depth_words(found: Findings) -> str:
    given_um = found.facts.experiment.observation_depth_um
    if given_um is not None:
        return f"Per volume, with the experiment's observation depth of {given_um:g} µm."
    if found.depth_um is not None:
        factor = f"{found.depth.per_radius:.2f} ± {found.depth.per_radius_std:.2f}"
        return f"Per volume, with a depth of ({factor}) r estimated from how long droplets stay in sight (section 4.3)."
    return "Per area: the observed depth is unknown."
