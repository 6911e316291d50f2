"""Results as the API shows them."""

from enum import StrEnum
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from dropflow.exports.kinds import Kind
from dropflow.statistics.oscillations import Signal


class FigureName(StrEnum):
    """The figures of a run: `dropflow.figures.catalogue` says what each is."""

    PHASE_DIAGRAM = "phase_diagram"
    THRESHOLDING = "thresholding"
    WATERSHED = "watershed"
    MATCH = "match"
    FLOW_FIELD = "flow_field"
    DISPLACEMENT = "displacement"
    FORWARD_TRACKING = "forward_tracking"
    BACKWARD_TRACKING = "backward_tracking"
    VELOCITY_AGAINST_RADIUS = "velocity_against_radius"
    SELF_CALIBRATION = "self_calibration"
    TRAJECTORY_LENGTHS = "trajectory_lengths"
    OBSERVED_DEPTH = "observed_depth"
    RADIUS_SCATTER = "radius_scatter"
    SIZE_DISTRIBUTION_BEFORE = "size_distribution_before"
    SIZE_DISTRIBUTION_AFTER = "size_distribution_after"
    SIZE_DISTRIBUTION_AT = "size_distribution_at"
    MOMENTS = "moments"
    FLOW_MOMENTS = "flow_moments"
    FLOW_BINS = "flow_bins"
    FLOW_CORRELATION = "flow_correlation"
    OSCILLATIONS = "oscillations"
    PERIODS = "periods"
    TEMPERATURE = "temperature"
    DRIVING = "driving"
    GROWTH = "growth"
    COLLISION_EFFICIENCY = "collision_efficiency"
    COALESCENCE = "coalescence"
    VISCOSITY = "viscosity"


class FigureParameter(BaseModel):
    """Something that can be asked of a figure, as a query parameter."""

    name: str
    kind: str
    """`number`, `integer` or `choice`."""
    unit: str | None
    description: str
    is_required: bool
    low: float | None
    """Of what there is in this run."""
    high: float | None
    choices: list[str] | None
    default: str | None


class FigureEntry(BaseModel):
    """A figure that can be asked for."""

    name: FigureName
    title: str
    paper: str
    """Where the paper has it."""
    group: str
    """`sizes`, `droplets`, `flow`, `time`, `fluid` or `frame`."""
    how: str
    """How it is computed."""
    docs: str
    """Its page, below `docs/`."""
    has_table: bool
    """Whether its numbers can be had as `table.csv`."""
    parameters: list[FigureParameter]
    is_available: bool
    reason: str | None
    """Why it is not."""


class FigureEntries(BaseModel):
    """All figures, in the order of the paper."""

    items: list[FigureEntry]


class FigureQuery(BaseModel):
    """What can be asked of figures. Each takes some of these: see the list of figures."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)

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
    frame: Annotated[int, Field(ge=0, le=2**31 - 1)] | None = None
    """Which frame."""
    trajectory: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = None
    """Which trajectory."""


class Figure(BaseModel):
    """A Plotly figure."""

    data: list[dict[str, Any]]
    layout: dict[str, Any]


class Which(StrEnum):
    """Before or after the consistency check of tracking."""

    DETECTED = "detected"
    TRACKED = "tracked"


class FrameDroplets(BaseModel):
    """The droplets of one frame, one array a column; the last six where they were tracked."""

    frame: int
    x_px: list[float]
    y_px: list[float]
    r_px: list[float]
    match: list[float]
    trajectory_id: list[int] | None = None
    is_detected: list[bool] | None = None
    """Else found by prediction."""
    next_x_px: list[float | None] | None = None
    """Where it is in the next frame; null where its trajectory ends."""
    next_y_px: list[float | None] | None = None
    next_r_px: list[float | None] | None = None


class FrameFlow(BaseModel):
    """The flow between a frame and the next on the grid; arrays are [row][column]."""

    frame: int
    grid_x_px: list[float]
    grid_y_px: list[float]
    u_um_s: list[list[float | None]]
    v_um_s: list[list[float | None]]
    droplet_count: list[list[int]]
    is_interpolated: list[list[bool]]


class Export(BaseModel):
    """A form in which results can be had."""

    kind: Kind
    title: str
    file_name: str
    media_type: str
    is_available: bool
    """From when the analysis is complete; it is made while it is sent, so its size is not known before."""


class Exports(BaseModel):
    """All forms."""

    items: list[Export]


class ResultFile(BaseModel):
    """Something to download."""

    name: str
    size_bytes: int
    media_type: str
    sha256: str | None = None
    """Of its bytes; not known of what was made before version 0.2."""


class ResultFiles(BaseModel):
    """What there is to download so far."""

    items: list[ResultFile]
