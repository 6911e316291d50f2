"""/experiments/{id}/imports."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query

from backend.experiments.errors import NoSuchExperiment
from backend.experiments.schemas import Experiment
from backend.experiments.service import shown
from backend.imports import service
from backend.imports.errors import FramesThere, NoSuchRoot, RootAway
from backend.imports.schemas import NewImport, Place
from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency
from backend.platform.problems import InvalidRequest, responses
from backend.platform.store_errors import StoreFull
from backend.platform.texts import Words
from backend.stacks.errors import StackClosed, TooLarge

router = APIRouter(prefix="/experiments/{experiment_id}/imports", tags=["frames"])


@router.get("", responses=responses(NoSuchExperiment, NoSuchRoot, RootAway, InvalidRequest))
def imports_look(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    root: Annotated[Words, Query(max_length=50)] | None = None,
    path: Annotated[Words, Query(max_length=1000)] = "",
) -> Place:
    """Look where frames can be imported from: the roots of this service, and what is in a folder below one."""
    return service.look(session, platform, viewer, experiment_id, root, path)


@router.post(
    "",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(
        NoSuchExperiment, NoSuchRoot, StackClosed, FramesThere, TooLarge, StoreFull, RootAway, InvalidRequest
    ),
)
def imports_create(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    new: NewImport,
) -> Experiment:
    """Import frames from a folder of the server or a prefix of S3; a worker brings them in and reads every frame.

    `stack.importing` says how far that is. `DELETE .../stack` gives it up.
    """
    return shown(session, viewer, service.create(session, platform, viewer, experiment_id, new))
