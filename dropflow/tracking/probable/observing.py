"""From droplets seen at both ends of a step to velocities with their errors."""

from dataclasses import replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.candidates import TAIL
from dropflow.tracking.probable.directions import turned, unturned
from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.regression import WaveFlow
from dropflow.tracking.probable.ways import is_far, ways


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


def along_ways(seen: Observations, flow: WaveFlow, px_per_um_s: float) -> Observations:
    """The same velocities as those that droplets had half-way through a flow, at the places where they were then.

    `observe` takes the way for straight and the velocity for that in its middle. Of droplets that go far in a step
    neither is true: what `flow` makes of their way is taken off.

    Parameters
    ----------
    seen : Observations
        As `observe` gives them, shape (n,).
    flow : WaveFlow
        The flow of this step or, as it changes little, of the one before.
    px_per_um_s : float
        Displacement in the step by a velocity of 1 um/s, px.
    """
    up = flow.model.up
    step_px = unturned(seen.across_um_s, seen.along_um_s + seen.sedimentation_um_s, up) * px_per_um_s
    far = np.flatnonzero(is_far(flow, step_px))
    if not len(far):
        return seen
    step_px, sedimentation = step_px[:, far], seen.sedimentation_um_s[far]
    x, y, across, along = (values.copy() for values in (seen.x_px, seen.y_px, seen.across_um_s, seen.along_um_s))
    own = np.outer(up, sedimentation * (1 + flow.stokes_error[0]))
    thought = ways(flow, np.stack([x[far], y[far]]) - step_px / 2, own * px_per_um_s, px_per_um_s)
    x[far], y[far] = thought.middle + (step_px - thought.step) / 2
    velocity = flow.at(*thought.middle) + own + (step_px - thought.step) / px_per_um_s
    across[far], total = turned(velocity[0], velocity[1], up)
    along[far] = total - sedimentation
    return replace(seen, x_px=x, y_px=y, across_um_s=across, along_um_s=along)


def deviations(seen: Observations, flow: WaveFlow) -> tuple[Column, Column]:
    """What droplets did beyond flow and Stokes, across `up` and along it, um/s."""
    velocity = flow.at(seen.x_px, seen.y_px)
    across, along = turned(velocity[0], velocity[1], flow.model.up)
    stokes_error = flow.stokes_error[0]
    return seen.across_um_s - across, seen.along_um_s - along - stokes_error * seen.sedimentation_um_s


def trusted(seen: Observations, squared_distance: Column) -> Observations:
    """What lies far off, in units of its errors, weighs less: t distributions instead of normal ones."""
    return replace(seen, weight=seen.weight * np.minimum(1.0, (TAIL + 2) / (TAIL + squared_distance)))
