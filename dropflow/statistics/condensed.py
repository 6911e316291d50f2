"""What every figure of a film is drawn from: the parts, whoever holds them.

`dropflow.statistics.condense` computes it from the tables, `dropflow.statistics.condensed_files` keeps it beside them.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.physics.over_time import MaterialOverTime
from dropflow.statistics.calibration import Calibration
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_correlation import FlowCorrelation
from dropflow.statistics.flow_moments import FlowMoments
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.lengths import ObservedDepth

Floats = npt.NDArray[np.float64]

N_RADIUS_BINS = 20


@dataclass(frozen=True)
class Clock:
    """When each frame was taken, and how warm it was."""

    time_s: Floats
    """Shape (n_frames,)."""
    temperature_c: Floats
    """Shape (n_frames,), or (0,) where there is no temperature log."""
    delta_density_kg_m3: Floats
    """Of droplets over fluid, shape (n_frames,)."""
    viscosity_pa_s: Floats
    """Of the fluid, shape (n_frames,)."""

    @property
    def material(self) -> MaterialOverTime:
        """The material in each frame."""
        return MaterialOverTime(self.delta_density_kg_m3, self.viscosity_pa_s)


class Condensed(Protocol):
    """The parts, each read or computed when it is first asked for."""

    @property
    def clock(self) -> Clock:
        """Times and temperatures."""
        ...

    @property
    def before(self) -> FrameHistograms:
        """All detections by frame and radius."""
        ...

    @property
    def after(self) -> FrameHistograms:
        """What tracking leaves of them (`dropflow.statistics.counted`)."""
        ...

    @property
    def flow(self) -> FlowMoments:
        """Mean and rms of the flow of each step."""
        ...

    @property
    def correlation(self) -> FlowCorrelation:
        """Correlation of the flow over distance and time."""
        ...

    @property
    def calibration(self) -> Calibration:
        """Density difference over viscosity from the droplets' own velocities."""
        ...

    @property
    def depth(self) -> ObservedDepth:
        """The depth in which droplets are seen, from how long they stay."""
        ...

    @property
    def seen(self) -> InSight | None:
        """How long droplets stay in sight; None while that is not known yet."""
        ...

    @property
    def trajectories(self) -> pl.DataFrame:
        """One row a trajectory."""
        ...

    @property
    def events(self) -> pl.DataFrame:
        """One row a coalescence."""
        ...


def statistics_edges_um(facts: FilmFacts, n_bins: int = N_RADIUS_BINS) -> Floats:
    """Edges of the radius bins of statistics against radius, over all radii that were looked for."""
    detection = facts.parameters.detection
    return radius_edges_um(detection.radius_min_um, detection.radius_max_um, n_bins)
