"""What a figure of a film is: its words, what it can be asked, and how it is drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import plotly.graph_objects as go
import polars as pl

from dropflow.figures.layout import caption_of
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings
from dropflow.statistics.oscillations import Signal


class Group(StrEnum):
    """What a figure is about."""

    SIZES = "sizes"
    DROPLETS = "droplets"
    FLOW = "flow"
    TIME = "time"
    FLUID = "fluid"
    FRAME = "frame"


class Needs(StrEnum):
    """After which stage a figure can be drawn."""

    NOTHING = "nothing"
    DETECT = "detect"
    TRACK = "track"
    ANALYSE = "analyse"


@dataclass(frozen=True)
class Parameter:
    """Something that can be asked of a figure."""

    name: str
    kind: str
    """``number``, ``integer`` or ``choice``."""
    description: str
    unit: str | None = None
    is_required: bool = False
    choices: tuple[str, ...] = ()


FROM_S = Parameter("from_s", "number", "Leave out what is before.", "s")
TO_S = Parameter("to_s", "number", "Leave out what is after.", "s")
RADIUS_MIN_UM = Parameter("radius_min_um", "number", "Leave out smaller droplets.", "µm")
RADIUS_MAX_UM = Parameter("radius_max_um", "number", "Leave out larger droplets.", "µm")
SIGNAL = Parameter("signal", "choice", "In what oscillations are looked for.", choices=tuple(Signal))
FRAME = Parameter("frame", "integer", "Which frame.", is_required=True)
ANY_FRAME = Parameter("frame", "integer", "Which frame; without it the one in the middle of the film.")
TRAJECTORY = Parameter("trajectory", "integer", "Which trajectory.", is_required=True)
TIMES, RADII = (FROM_S, TO_S), (RADIUS_MIN_UM, RADIUS_MAX_UM)

Draw = Callable[..., go.Figure]


@dataclass(frozen=True)
class Drawing:
    """How a figure is made, and of what."""

    draw: Draw | None = None
    """Takes the findings, title and caption; None for what needs a frame, too."""
    table: Callable[[Findings], pl.DataFrame] | None = None
    """Its numbers."""
    parameters: tuple[Parameter, ...] = ()
    missing: Callable[[FilmFacts], str | None] = lambda facts: None  # noqa: ARG005 - most need nothing of the film
    """Why it cannot be drawn of a film, or None."""


@dataclass(frozen=True)
class Entry:
    """One figure."""

    name: str
    title: str
    paper: str
    """Where the paper has it."""
    group: Group
    needs: Needs
    docs: str
    """Its page below ``docs/explanation/figures``, without the ending."""
    how: str
    """How it is computed, in a sentence or two."""
    drawing: Drawing


def draw(entry: Entry, found: Findings) -> go.Figure:
    """Draw a figure of a film."""
    assert entry.drawing.draw is not None  # noqa: S101 - whoever draws frames knows them by name
    return entry.drawing.draw(found, title=entry.title, caption=caption_of(found.facts.caption()))
