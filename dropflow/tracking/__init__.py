"""From the droplets of single frames to trajectories and the flow between frames (sections 3.2 and 3.3)."""

from dropflow.tracking.flow import FlowField
from dropflow.tracking.track import TrackingResult, track

__all__ = ["FlowField", "TrackingResult", "track"]
