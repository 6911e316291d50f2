"""Runs beside each other, as the API shows them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any
from uuid import UUID

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat

from backend.models.states import RunState
from backend.results.schemas import FigureParameter
from dropflow.statistics.oscillations import Signal

MOST_RUNS = 8


def _distinct(runs: list[UUID]) -> list[UUID]:
    if len(set(runs)) < len(runs):
        raise ValueError("A run can be named once.")
    return runs


class ComparisonQuery(BaseModel):
    """Which runs, in the order in which they are shown."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

    run: Annotated[list[UUID], Field(min_length=1, max_length=MOST_RUNS), AfterValidator(_distinct)]
    """Ids of runs: `run=...&run=...`."""


class ComparisonFigureQuery(ComparisonQuery):
    """The same, and what can be asked of figures. Each takes some of these."""

    from_s: FiniteFloat | None = None
    """Leave out what is before."""
    to_s: FiniteFloat | None = None
    """Leave out what is after."""
    radius_min_um: Annotated[FiniteFloat, Field(gt=0)] | None = None
    """Leave out smaller droplets."""
    radius_max_um: Annotated[FiniteFloat, Field(gt=0)] | None = None
    """Leave out larger droplets."""
    signal: Signal | None = None
    """In what oscillations are looked for."""


class ComparisonFigureName(StrEnum):
    """The figures of several runs: `dropflow.figures.compared` says what each is."""

    SIZE_DISTRIBUTION_AT = "size_distribution_at"
    MOMENTS = "moments"
    VELOCITY_AGAINST_RADIUS = "velocity_against_radius"
    FLOW_MOMENTS = "flow_moments"
    PERIODS_AGAINST_DRIVING = "periods_against_driving"


class ComparedRun(BaseModel):
    """One of the runs."""

    id: UUID
    experiment_id: UUID
    experiment_name: str
    number: int
    label: str
    """What it is called in figures and tables."""
    colour: str
    """Of its lines in figures."""
    state: RunState
    created_at: datetime
    version: str
    n_frames: int | None


class ComparedNumber(BaseModel):
    """A number of all runs."""

    name: str
    """Its dotted path in `summary.json`."""
    title: str
    unit: str | None
    values: list[float | None]
    """In the order of the runs; null where a run has none, or none yet."""
    stds: list[float | None] | None
    """Standard errors, for numbers that have one."""


class ComparedField(BaseModel):
    """A field in which not all runs are alike."""

    name: str
    """Dotted path."""
    values: list[Any]
    """In the order of the runs; null where a run lacks it."""


class ComparisonFigureEntry(BaseModel):
    """A figure that can be asked for."""

    name: ComparisonFigureName
    title: str
    how: str
    """How it is computed."""
    docs: str
    """Its page, below `docs/`."""
    parameters: list[FigureParameter]
    is_available: bool
    """Whether any of the runs has something for it."""
    reason: str | None
    """Why it is not."""


class Comparison(BaseModel):
    """Runs beside each other."""

    runs: list[ComparedRun]
    numbers: list[ComparedNumber]
    parameters: list[ComparedField]
    """Of the analyses; only those that differ."""
    experiment: list[ComparedField]
    """Of what was filmed; only what differs."""
    figures: list[ComparisonFigureEntry]
