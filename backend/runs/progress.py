"""How fast a stage goes and how long it takes yet: pure, from what is done and since when."""

from collections.abc import Mapping
from datetime import datetime
from uuid import UUID

from backend.models import Run, Stage
from backend.models.states import StageState
from backend.runs import schemas
from backend.runs.repository import Done


def shown_stages(run: Run, done: Mapping[tuple[UUID, str], Done], now: datetime) -> list[schemas.Stage]:
    """The stages of a run as people see them."""
    return [_shown_stage(stage, done.get((run.id, stage.name), Done(0, 0)), now) for stage in run.stages]


def _shown_stage(stage: Stage, done: Done, now: datetime) -> schemas.Stage:
    """A stage as people see it. Frames taken over from an earlier run say nothing about the speed of this one."""
    n_done = stage.total_frames if stage.state == StageState.COMPLETED else min(done.frames, stage.total_frames)
    frames_per_s = None
    if stage.state == StageState.RUNNING and stage.started_at is not None:
        elapsed_s = (now - stage.started_at).total_seconds()
        n_worked = done.frames - done.reused_frames
        frames_per_s = n_worked / elapsed_s if n_worked > 0 and elapsed_s > 0 else None
    return schemas.Stage(
        name=schemas.StageName(stage.name),
        state=stage.state,
        done_frames=n_done,
        total_frames=stage.total_frames,
        reused_frames=done.reused_frames,
        frames_per_s=None if frames_per_s is None else round(frames_per_s, 3),
        seconds_left=None if frames_per_s is None else round((stage.total_frames - n_done) / frames_per_s, 1),
    )
