"""How fast a stage goes, how long it takes yet and how sure that is: pure, from how long what is done has taken."""

import math
from collections.abc import Mapping
from uuid import UUID

from backend.models import Run, Stage
from backend.models.states import StageState
from backend.runs import schemas
from backend.runs.repository import Done


def shown_stages(run: Run, done: Mapping[tuple[UUID, str], Done]) -> list[schemas.Stage]:
    """The stages of a run as people see them."""
    return [_shown_stage(stage, done.get((run.id, stage.name), Done(0, 0))) for stage in run.stages]


def _shown_stage(stage: Stage, done: Done) -> schemas.Stage:
    n_done = stage.total_frames if stage.state == StageState.COMPLETED else min(done.frames, stage.total_frames)
    frames_per_s, left = None, None
    if stage.state == StageState.RUNNING and done.seconds_per_frame and done.n_busy:
        frames_per_s = done.n_busy / done.seconds_per_frame
        left = seconds_left(stage.total_frames - n_done, done)
    return schemas.Stage(
        name=schemas.StageName(stage.name),
        state=stage.state,
        done_frames=n_done,
        total_frames=stage.total_frames,
        reused_frames=done.reused_frames,
        frames_per_s=None if frames_per_s is None else round(frames_per_s, 3),
        seconds_left=None if left is None else round(left[0], 1),
        seconds_left_std=None if left is None else round(left[1], 1),
    )


def seconds_left(n_frames: int, done: Done) -> tuple[float, float]:
    """Time for `n_frames` more, and its standard deviation.

    The stretches to come differ among each other as those so far did, and the mean of those so far is known as well as
    their number allows: with R frames left, k stretches of m frames each and s the deviation of the seconds a frame,
    the variance is R m s^2 + R^2 s^2 / k. Processes that work beside each other share it all.
    """
    if done.seconds_per_frame is None or done.seconds_per_frame_std is None:
        raise ValueError("Nothing was timed yet.")
    n_together = max(done.n_busy, 1)
    frames_per_sample = done.n_timed / max(done.n_samples, 1)
    variance = n_frames * frames_per_sample + n_frames**2 / max(done.n_samples, 1)
    std_s = done.seconds_per_frame_std * math.sqrt(variance)
    return n_frames * done.seconds_per_frame / n_together, std_s / n_together
