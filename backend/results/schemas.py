"""Results as the API shows them."""

from enum import StrEnum
from typing import Any

from pydantic import BaseModel


class FigureName(StrEnum):
    """The figures of a run."""

    SIZE_DISTRIBUTION_BEFORE = "size_distribution_before"
    SIZE_DISTRIBUTION_AFTER = "size_distribution_after"
    MOMENTS = "moments"
    FLOW_FIELD = "flow_field"
    FLOW_MOMENTS = "flow_moments"


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
