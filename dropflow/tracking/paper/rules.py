"""What the paper pairs and averages (section 3.2)."""

from dataclasses import dataclass

import numpy as np

from dropflow.droplets import Droplets
from dropflow.parameters import FlowParameters, TrackingParameters
from dropflow.tracking.flow import FlowField
from dropflow.tracking.grid import Grid
from dropflow.tracking.identification import Pairs, closest_pairs
from dropflow.tracking.paper.cell_average import cell_average
from dropflow.tracking.prediction import Motion


@dataclass(frozen=True)
class PaperRules:
    """Closest similar droplet, average over cells."""

    grid: Grid
    motion: Motion
    tracking: TrackingParameters
    flow: FlowParameters

    @property
    def similar_ratio(self) -> tuple[float, float]:
        """Between which the ratio of similar radii lies."""
        return self.tracking.paper.similar_ratio_min, self.tracking.paper.similar_ratio_max

    def pair(self, predicted: Droplets, candidates: Droplets, *, spacing_px: float) -> Pairs:
        """The closest similar pairs, up to a part of the spacing, or the radius, apart (section 3.2.1)."""
        reach_px = np.maximum(predicted.r_px, self.tracking.paper.reach_spacings * spacing_px)
        return closest_pairs(predicted, candidates, reach_px=reach_px, similar_ratio=self.similar_ratio)

    def flow_between(self, before: Droplets, after: Droplets, dt_s: float) -> FlowField:
        """The flow that carried droplets from `before` to `after` (same droplets, same order) in `dt_s`."""
        advection_um_s = self.motion.advection_um_s(before, after, dt_s)
        return cell_average(self.grid, before.x_px, before.y_px, advection_um_s, self.flow.paper)
