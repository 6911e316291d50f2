"""The way of a droplet in a step: straight where it is short, along the turns of the flow where it is long."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.regression import WaveFlow

_SHORT_LENGTHS = 0.25
"""Of the correlation length: over a shorter way the flow midway is the mean, to half a hundredth."""


@dataclass(frozen=True)
class Ways:
    """From start to end of a step; each attribute of shape (2, n), in image axes."""

    middle_px: Column
    """Place when half of the time has gone."""
    velocity_um_s: Column
    """Of the droplets there."""
    step_px: Column
    """From start to end."""

    def __getitem__(self, which: npt.NDArray[np.int64]) -> "Ways":
        return Ways(self.middle_px[:, which], self.velocity_um_s[:, which], self.step_px[:, which])


def ways(flow: WaveFlow, start_px: Column, own_um_s: Column, px_per_um_s: float) -> Ways:
    """Where droplets go that the flow carries while they move in it.

    Parameters
    ----------
    flow : WaveFlow
        Constant during the step.
    start_px : ndarray, float64, shape (2, n)
    own_um_s : ndarray, float64, shape (2, n)
        Velocity in the flow: sedimentation and the like.
    px_per_um_s : float
        Displacement in the step by a velocity of 1 um/s, px; negative back in time.
    """
    own_px = own_um_s * px_per_um_s
    step = _step(flow, start_px, own_px, px_per_um_s)
    middle = start_px + step / 2
    far = np.flatnonzero(is_far(flow, step))
    if len(far):
        longest_lengths = np.hypot(*step[:, far]).max() / flow.model.spectrum.length_px
        n_steps = math.ceil(longest_lengths / (2 * _SHORT_LENGTHS))
        half_way = _path(flow, start_px[:, far], own_px[:, far] / 2, px_per_um_s / 2, n_steps)
        end = _path(flow, half_way, own_px[:, far] / 2, px_per_um_s / 2, n_steps)
        middle[:, far], step[:, far] = half_way, end - start_px[:, far]
    return Ways(middle, own_um_s + flow.at(*middle), step)


def is_far(flow: WaveFlow, step_px: Column) -> npt.NDArray[np.bool_]:
    """Whether a displacement, shape (2, n), px, is so long that the way cannot be taken for straight."""
    return np.asarray(np.hypot(*step_px) > _SHORT_LENGTHS * flow.model.spectrum.length_px)


def _path(flow: WaveFlow, start: Column, own_px: Column, px_per_um_s: float, n_steps: int) -> Column:
    """Where short steps one after another lead."""
    place = start
    for _ in range(n_steps):
        place = place + _step(flow, place, own_px / n_steps, px_per_um_s / n_steps)
    return place


def _step(flow: WaveFlow, start: Column, own_px: Column, px_per_um_s: float) -> Column:
    """A displacement by the flow in its middle (the midpoint rule)."""
    middle = start + (own_px + flow.at(*(start + own_px / 2)) * px_per_um_s) / 2
    return np.asarray(own_px + flow.at(*middle) * px_per_um_s)
