"""Experiments as the API shows and takes them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Any
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict

from backend.groups.schemas import Group
from backend.models import ImportMode
from backend.models.states import RunState, StackState
from backend.platform.pages import ListQuery, Moment, Page
from backend.platform.problems import Problem
from backend.platform.texts import Words
from backend.runs.schemas import Stage

EXAMPLE_DOCUMENT: JsonDict = {
    "name": "isobutoxyethanol, bottom phase",
    "pixel_size_um": 0.625,
    "frame_interval_s": 1.0,
    "droplets": "bright",
    "up": [0, -1],
    "phase": "bottom",
    "material": {"delta_density_kg_m3": -30.0, "viscosity_pa_s": 0.0014},
}


class Confirmation(BaseModel):
    """A person has said that order, times and scale of the frames are right as they are now."""

    by: str
    at: datetime


class Importing(BaseModel):
    """How far an import is."""

    model_config = ConfigDict(from_attributes=True)

    root: str
    path: str
    mode: ImportMode
    n_files: int
    size_bytes: int
    done_bytes: int
    bytes_per_s: float | None


class Stack(BaseModel):
    """The frames of an experiment."""

    model_config = ConfigDict(from_attributes=True)

    state: StackState
    n_files: int
    size_bytes: int
    n_frames: int | None
    rows: int | None
    columns: int | None
    dtype: str | None
    duration_s: float | None
    checksum: str | None
    """Of the frames' content. Give it as `v` to a frame's address and the frame may be kept for ever."""
    done_frames: int | None
    """Frames read so far while `indexing`."""
    importing: Importing | None
    """While `indexing`: how far the files are that are imported first."""
    problem: Problem | None
    warnings: list[str]
    broken_frames: list[int]
    """Those of the files that cannot be read and are left out."""
    confirmation: Confirmation | None


class RunSummary(BaseModel):
    """A run in a list."""

    id: UUID
    number: int
    state: RunState
    created_at: datetime
    finished_at: datetime | None
    stages: list[Stage]
    n_droplets: int | None
    """Found in all frames, once the run is completed."""


class Experiment(BaseModel):
    """What was filmed, its frames and its latest run."""

    id: UUID
    group: Group
    experiment: dict[str, Any]
    """The document, as `GET /schemas/experiment` describes it."""
    created_at: datetime
    updated_at: datetime
    stack: Stack
    n_runs: int
    latest_run: RunSummary | None


class Experiments(Page[Experiment]):
    """Some experiments."""


class ExperimentSort(StrEnum):
    """What experiments are sorted by; a minus means the largest or latest first."""

    NEWEST = "-created_at"
    OLDEST = "created_at"
    LAST_CHANGED = "-updated_at"
    FIRST_CHANGED = "updated_at"
    NAME = "name"
    NAME_REVERSED = "-name"


class ExperimentQuery(ListQuery):
    """Which experiments, and in which order."""

    sort: ExperimentSort = ExperimentSort.NEWEST
    """The order."""
    q: Annotated[Words, Field(max_length=200)] | None = None
    """Words of the name, the notes or a tag, in any case; all of them must be there."""
    tag: Annotated[Words, Field(max_length=100)] | None = None
    """Experiments with exactly this tag."""
    group_id: UUID | None = None
    """Experiments of this group."""
    stack_state: StackState | None = None
    """Experiments whose frames are in this state."""
    run_state: RunState | None = None
    """Experiments that have a run in this state."""
    created_from: Moment | None = None
    """Made at this time or later."""
    created_before: Moment | None = None
    """Made before this time."""


class NewExperiment(BaseModel):
    """What a new experiment needs."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"experiment": EXAMPLE_DOCUMENT}]})

    experiment: dict[str, Any]
    """The document, as `GET /schemas/experiment` describes it."""
    group_id: UUID | None = None
    """The group it belongs to; without it, your first."""


class ChangeExperiment(BaseModel):
    """The whole new document."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"experiment": EXAMPLE_DOCUMENT}]})

    experiment: dict[str, Any]


class MoveExperiment(BaseModel):
    """The group that an experiment is to belong to."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"group_id": "6f9619ff-8b86-4d01-b42d-00cf4fc964ff"}]}
    )

    group_id: UUID
