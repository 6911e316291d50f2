"""Trajectories as the API shows them."""

from pydantic import BaseModel


class Tails(BaseModel):
    """Where the droplets of a frame were in the frames before it, one polyline a trajectory.

    Points `offsets[k]` to `offsets[k + 1]` belong to `trajectory_id[k]`, in the order of frames.
    """

    frame: int
    n_frames: int
    """How far back the tails go."""
    trajectory_id: list[int]
    offsets: list[int]
    x_px: list[float]
    y_px: list[float]


class Trajectory(BaseModel):
    """One droplet over all frames in which it was followed, one array a column."""

    trajectory_id: int
    frame: list[int]
    time_s: list[float]
    x_px: list[float]
    y_px: list[float]
    r_um: list[float]
    r_std_um: list[float | None]
    match: list[float | None]
    probability: list[float | None]
    is_detected: list[bool]
    """Else found by prediction."""
    u_um_s: list[float | None]
    """Velocity along x (to the right) towards the next frame."""
    v_um_s: list[float | None]
    """Velocity along y (downwards)."""
    sedimentation_um_s: list[float | None]
    """The part of Stokes' law along `up`: positive where the droplet rises."""
    up: tuple[float, float]
    """Direction against gravity in image axes."""
