"""The rows of an experiment whose frames are there and of a run of it that completed, without any frames or results."""

from typing import Any
from uuid import UUID

from sqlalchemy.orm import Session

from backend.models import Experiment, Run, Stack
from backend.models.states import RunState, StackState


def completed_run(
    session: Session, group_id: UUID, document: dict[str, Any], shape: tuple[int, int], n_frames: int, **known: Any
) -> Run:
    """One frame a second; `known` is what else is known of the run, by the columns of its table."""
    stack = Stack(
        state=StackState.READY,
        n_frames=n_frames,
        rows=shape[0],
        columns=shape[1],
        dtype="uint8",
        duration_s=n_frames - 1.0,
        checksum="0" * 64,
    )
    experiment = Experiment(group_id=group_id, document=document, stack=stack)
    session.add(experiment)
    session.flush()
    run = Run(
        experiment_id=experiment.id,
        number=1,
        state=RunState.COMPLETED,
        document=document,
        version="0",
        **{"parameters": {}, "stages": [], **known},
    )
    session.add(run)
    session.flush()
    return run
