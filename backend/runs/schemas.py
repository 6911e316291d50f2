"""Runs as the API shows and takes them."""

from datetime import datetime
from enum import StrEnum
from typing import Any
from uuid import UUID

from pydantic import BaseModel, ConfigDict

from backend.models.states import RunState, StageState
from backend.platform.pages import ListQuery, Moment, Page
from backend.platform.problems import Problem


class StageName(StrEnum):
    """What a run does, in this order."""

    DETECT = "detect"
    TRACK = "track"
    ANALYSE = "analyse"


class Stage(BaseModel):
    """How far one stage is."""

    name: StageName
    state: StageState
    done_frames: int
    total_frames: int
    reused_frames: int
    """Of the frames that are done, those that an earlier run had done already."""
    frames_per_s: float | None
    seconds_left: float | None
    seconds_left_std: float | None
    """How sure that is: its standard deviation, from how much the frames so far differed."""


class Run(BaseModel):
    """One analysis."""

    id: UUID
    experiment_id: UUID
    number: int
    state: RunState
    is_cancelling: bool
    """It was asked to stop, and workers are letting go."""
    parameters: dict[str, Any]
    """All of them, as `GET /schemas/parameters` describes them."""
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    version: str
    """Of the software that this run was made with."""
    stages: list[Stage]
    problem: Problem | None
    summary: dict[str, Any] | None
    """What `summary.json` holds."""
    warnings: list[str]


class Cause(StrEnum):
    """What kind of input differs."""

    PARAMETER = "parameter"
    EXPERIMENT = "experiment"
    FRAMES = "frames"
    CODE = "code"
    NOT_THERE = "not_there"


class Difference(BaseModel):
    """Something that went into a stage of this run and not of the earlier one."""

    cause: Cause
    field: str | None = None
    """Dotted path, for parameters and the experiment."""
    before: Any = None
    now: Any = None


class StageReuse(BaseModel):
    """What a stage took over from earlier runs, and why not the rest."""

    name: StageName
    total_frames: int
    reused_frames: int
    differences: list[Difference]
    """Against the run compared with. Empty where all was taken over."""


class Reuse(BaseModel):
    """What a run took over from earlier ones, and why not the rest."""

    compared_with: int | None
    """Number of the run before; null for the first of an experiment."""
    stages: list[StageReuse]


class Runs(Page[Run]):
    """Some runs."""


class RunSort(StrEnum):
    """What runs are sorted by; a minus means the latest first."""

    NEWEST = "-created_at"
    OLDEST = "created_at"


class RunQuery(ListQuery):
    """Which runs, and in which order."""

    sort: RunSort = RunSort.NEWEST
    """The order."""
    state: RunState | None = None
    """Runs in this state."""
    created_from: Moment | None = None
    """Begun at this time or later."""
    created_before: Moment | None = None
    """Begun before this time."""


class NewRun(BaseModel):
    """What a new run needs."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"parameters": {"detection": {"radius_min_um": 4.0, "radius_max_um": 40.0}}}]},
    )

    parameters: dict[str, Any] = {}
    """Those that differ from their defaults."""
