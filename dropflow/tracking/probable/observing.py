"""From droplets seen at both ends of a step to velocities with their errors."""

from dataclasses import replace

import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.candidates import TAIL
from dropflow.tracking.probable.directions import Up, turned, unturned
from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.regression import WaveFlow
from dropflow.tracking.probable.ways import Ways, is_far, ways


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


def along(seen: Observations, thought: Ways, up: Up, px_per_um_s: float) -> Observations:
    """The same velocities as those that droplets had half-way, at the places where they were then.

    `observe` takes ways for straight and the velocity for that in their middle. Of droplets that go far in a step
    neither is true; they went as was thought, but for the little by which they came out elsewhere.

    Parameters
    ----------
    seen : Observations
        As `observe` gives them, shape (n,).
    thought : Ways
        Of these droplets, shape (n,), from the same starts.
    up : (float, float)
    px_per_um_s : float
        Displacement in the step by a velocity of 1 um/s, px.
    """
    step_px = _step_px(seen, up, px_per_um_s)
    x_px, y_px = thought.middle_px + (step_px - thought.step_px) / 2
    velocity = thought.velocity_um_s + (step_px - thought.step_px) / px_per_um_s
    across, along_up = turned(velocity[0], velocity[1], up)
    return replace(
        seen, x_px=x_px, y_px=y_px, across_um_s=across, along_um_s=np.asarray(along_up - seen.sedimentation_um_s)
    )


def along_flow(seen: Observations, flow: WaveFlow, px_per_um_s: float) -> Observations:
    """As `along`, with the ways in the flow of this step or, as it changes little, of the one before."""
    step_px = _step_px(seen, flow.model.up, px_per_um_s)
    if not is_far(flow, step_px).any():
        return seen
    start_px = np.stack([seen.x_px, seen.y_px]) - step_px / 2
    own_um_s = np.outer(flow.model.up, seen.sedimentation_um_s * (1 + flow.stokes_error[0]))
    return along(seen, ways(flow, start_px, own_um_s, px_per_um_s), flow.model.up, px_per_um_s)


def _step_px(seen: Observations, up: Up, px_per_um_s: float) -> Column:
    """From start to end, shape (2, n)."""
    return unturned(seen.across_um_s, seen.along_um_s + seen.sedimentation_um_s, up) * px_per_um_s


def deviations(seen: Observations, flow: WaveFlow) -> tuple[Column, Column]:
    """What droplets did beyond flow and Stokes, across `up` and along it, um/s."""
    velocity = flow.at(seen.x_px, seen.y_px)
    across, along = turned(velocity[0], velocity[1], flow.model.up)
    stokes_error = flow.stokes_error[0]
    return seen.across_um_s - across, seen.along_um_s - along - stokes_error * seen.sedimentation_um_s


def trusted(seen: Observations, squared_distance: Column) -> Observations:
    """What lies far off, in units of its errors, weighs less: t distributions instead of normal ones."""
    return replace(seen, weight=seen.weight * np.minimum(1.0, (TAIL + 2) / (TAIL + squared_distance)))
