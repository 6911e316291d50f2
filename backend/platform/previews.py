"""What the service asks of a worker while somebody waits, and how the answer comes back.

The request travels in the message and the answer through the object store: nothing of it is worth keeping, and who
gets none asks again.
"""

from typing import Any, Literal
from uuid import UUID

from pydantic import BaseModel, ConfigDict

PREVIEW_TASK = "worker.preview"


class Region(BaseModel):
    """A part of a frame, in pixels."""

    model_config = ConfigDict(extra="forbid", strict=True)

    x_px: int
    y_px: int
    width_px: int
    height_px: int


class PreviewRequest(BaseModel):
    """One look at what an analysis would do."""

    kind: Literal["droplets", "prepared", "links", "suggestions"]
    experiment_id: UUID
    answer_key: str
    """Where in the object store the answer is waited for."""
    asked_at_s: float
    """Time since the epoch: an old request is not worth an answer."""
    frame: int = 0
    region: Region | None = None
    parameters: dict[str, Any] = {}
    document: dict[str, Any] | None = None
    """What was filmed, as a run was told; None: as the experiment says now."""
    is_picture_wanted: bool = False
    trace: dict[str, str] = {}
    """What it is part of, if that is traced."""


LONGEST_WAIT_S = 60.0
"""Who asked has given up by then."""
