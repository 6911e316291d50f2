"""One Plotly figure per figure of the paper, named after what it shows and fit to print."""

from dropflow.figures.calibration import self_calibration
from dropflow.figures.coalescence import coalescence
from dropflow.figures.collision_efficiency import collision_efficiency
from dropflow.figures.flow_correlation import flow_correlation
from dropflow.figures.flow_field import flow_field
from dropflow.figures.flow_moments import flow_moments
from dropflow.figures.following import Direction, displacement, tracking_step
from dropflow.figures.layout import caption_of
from dropflow.figures.materials import phase_diagram, temperature_ramp, viscosity
from dropflow.figures.moments import moments
from dropflow.figures.oscillations import oscillating_signal, periods, periods_against_driving
from dropflow.figures.sedimentation import (
    growth,
    observed_depth,
    radius_scatter,
    trajectory_lengths,
    velocity_against_radius,
)
from dropflow.figures.size_distribution import size_distribution, size_distribution_at
from dropflow.figures.temperature import driving, temperature

__all__ = [
    "Direction",
    "caption_of",
    "coalescence",
    "collision_efficiency",
    "displacement",
    "driving",
    "flow_correlation",
    "flow_field",
    "flow_moments",
    "growth",
    "moments",
    "observed_depth",
    "oscillating_signal",
    "periods",
    "periods_against_driving",
    "phase_diagram",
    "radius_scatter",
    "self_calibration",
    "size_distribution",
    "size_distribution_at",
    "temperature",
    "temperature_ramp",
    "tracking_step",
    "trajectory_lengths",
    "velocity_against_radius",
    "viscosity",
]
