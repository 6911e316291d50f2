"""Quality over time as the API shows it."""

from pydantic import BaseModel

Column = list[float | None]


class Quality(BaseModel):
    """How well a run did over time: means over neighbouring frames, one array a column; null where there is nothing."""

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
