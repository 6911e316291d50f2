"""From droplets seen at both ends of a step to velocities with their errors."""

from dataclasses import replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.candidates import TAIL
from dropflow.tracking.probable.directions import turned
from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.regression import WaveFlow


def observe(
    motion: Motion,
    before: Droplets,
    after: Droplets,
    dt_s: float,
    *,
    log_r: Column,
    log_r_variance: Column,
    weight: Column,
) -> Observations:
    """Velocities of droplets over a step `dt_s` long, less their sedimentation.

    The radius to sediment with, and its error, are given apart: they are better known than in a single frame.
    """
    px_s = motion.pixel_size_um / dt_s
    across, along = turned((after.x_px - before.x_px) * px_s, (after.y_px - before.y_px) * px_s, motion.up)
    sedimentation = motion.sedimentation_um_s(np.exp(log_r))
    place = (before.x_std_px**2 + after.x_std_px**2) * px_s**2
    return Observations(
        (before.x_px + after.x_px) / 2,
        (before.y_px + after.y_px) / 2,
        across,
        along - sedimentation,
        sedimentation,
        np.asarray(place),
        np.asarray(place + 4 * sedimentation**2 * log_r_variance),
        weight,
    )


def deviations(seen: Observations, flow: WaveFlow) -> tuple[Column, Column]:
    """What droplets did beyond flow and Stokes, across `up` and along it, um/s."""
    velocity = flow.at(seen.x_px, seen.y_px)
    across, along = turned(velocity[0], velocity[1], flow.model.up)
    stokes_error = flow.stokes_error[0]
    return seen.across_um_s - across, seen.along_um_s - along - stokes_error * seen.sedimentation_um_s


def trusted(seen: Observations, squared_distance: Column) -> Observations:
    """What lies far off, in units of its errors, weighs less: t distributions instead of normal ones."""
    return replace(seen, weight=seen.weight * np.minimum(1.0, (TAIL + 2) / (TAIL + squared_distance)))
