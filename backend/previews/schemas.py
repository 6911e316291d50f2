"""Previews as the API takes and shows them."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from backend.platform.previews import Region


class PreviewWish(BaseModel):
    """A frame, perhaps a part of it, and the parameters to try on it."""

    model_config = ConfigDict(extra="forbid")

    frame: int = Field(ge=0, le=2**31 - 1, strict=True)
    parameters: dict[str, Any] = {}
    region: Region | None = None
    """Only this part is looked at, which is quicker; without it the whole frame."""
    is_picture_wanted: bool = False
    """Also answer the frame as detection sees it."""


class LinkWish(BaseModel):
    """A frame whose droplets are to be followed into the next, and the parameters to try."""

    model_config = ConfigDict(extra="forbid")

    frame: int = Field(ge=0, le=2**31 - 1, strict=True)
    parameters: dict[str, Any] = {}


class Rejected(BaseModel):
    """Candidates that were not taken for droplets, one array a column."""

    x_px: list[float]
    y_px: list[float]
    r_px: list[float]
    reason: list[str]


class Preview(BaseModel):
    """What detection finds with these parameters, one array a column."""

    frame: int
    region: Region | None
    x_px: list[float]
    y_px: list[float]
    r_px: list[float]
    match: list[float | None]
    probability: list[float | None]
    rejected: Rejected
    took_s: float
    """Time that detection itself took."""
    prepared_jpeg: str | None = None
    """The region, or the whole frame, as detection sees it: a JPEG in base64."""


class LinkPreview(BaseModel):
    """How droplets of a frame are followed into the next, one array a column."""

    frame: int
    x_px: list[float]
    y_px: list[float]
    r_px: list[float]
    is_detected: list[bool]
    next_x_px: list[float | None]
    """Where it was found; null where it was lost."""
    next_y_px: list[float | None]
    next_r_px: list[float | None]
    predicted_x_px: list[float | None]
    """Where flow and sedimentation take it."""
    predicted_y_px: list[float | None]
    n_frames: int
    """Frames that were followed for this, from this one on."""
    took_s: float


class Measurement(BaseModel):
    """Something measured on the frames."""

    name: str
    value: float | None
    unit: str
    about: str


class Suggestion(BaseModel):
    """A value for a parameter, with what speaks for it."""

    field: str
    value: float | str
    unit: str
    reason: str


class Suggestions(BaseModel):
    """Parameters proposed from what is measured on a few frames."""

    frames: list[int]
    measurements: list[Measurement]
    suggestions: list[Suggestion]
    warnings: list[str]
