"""Quality over time as the API shows it."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Column = list[float | None]
Limit = Annotated[float | None, Field(allow_inf_nan=False)]


class QualityQuery(BaseModel):
    """Which part of a film."""

    model_config = ConfigDict(extra="forbid")

    from_s: Limit = Field(None, description="Only frames from this time on.")
    to_s: Limit = Field(None, description="Only frames up to this time.")
    radius_min_um: Limit = Field(None, gt=0, description="Only droplets at least as large.")
    radius_max_um: Limit = Field(None, gt=0, description="Only droplets at most as large.")
    max_columns: int = Field(600, ge=1, le=5000, description="Neighbouring frames are summed up.")


class Quality(BaseModel):
    """How well a run did over time: means over neighbouring frames, one array a column; null where there is nothing."""

    is_of_radii: bool
    """Whether the columns are of the radii asked for; runs of earlier versions counted over all radii only."""
    trajectories: dict[str, int] | None
    """Of the part asked for: trajectories that were kept, and taken out by reason. Null where no part was asked for
    (then the summary of the run says it) or nothing is known."""
    first_frame: list[int]
    time_s: list[float]
    n_detected: Column
    """Droplets found by detection, a frame."""
    n_tracked: Column
    """Droplets on trajectories, a frame."""
    predicted_share: Column
    """Of these, found by prediction."""
    match: Column
    """Mean over the tracked droplets that detection found."""
    radius_std_share: Column
    """Mean relative standard deviation of the radius."""
    residual_px: Column
    """Root mean square distance between where flow and sedimentation take a droplet and where it is found."""
