"""Frames of an experiment, read where they are kept."""

from sqlalchemy.orm import Session

from backend.models import Experiment
from backend.platform.object_store import ObjectStore
from backend.platform.store_files import StoreFiles
from backend.platform.visibility import Viewer
from backend.stacks import service
from backend.stacks.images import OpenStacks
from dropflow.experiment import parse_experiment
from dropflow.frames import Choice, Frame, Frames, open_frames


def read_frame(
    stacks: OpenStacks, store: ObjectStore, session: Session, viewer: Viewer, experiment: Experiment, frame: int
) -> Frame:
    """One frame of an experiment whose stack is ready."""

    def open_stack() -> Frames:
        files = StoreFiles(store, service.frame_files(session, viewer, experiment.id))
        return open_frames(
            files, Choice.of(parse_experiment(experiment.document), tuple(experiment.stack.broken_frames))
        )

    return stacks.read(f"{experiment.id}/{experiment.stack.checksum}", frame, open_stack)
