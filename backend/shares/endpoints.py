"""/runs/{id}/shares."""

from http import HTTPStatus
from uuid import UUID

from fastapi import APIRouter

from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency
from backend.platform.problems import InvalidRequest, responses
from backend.runs.errors import NoSuchRun
from backend.shares import service
from backend.shares.errors import NoSuchShare
from backend.shares.schemas import MadeShare, NewShare, Shares

router = APIRouter(prefix="/runs/{run_id}/shares", tags=["runs"])


@router.get("", responses=responses(NoSuchRun, InvalidRequest))
def shares_list(session: SessionDependency, viewer: EditorDependency, run_id: UUID) -> Shares:
    """List the links by which anybody may look at a run."""
    return Shares(items=service.shares(session, viewer, run_id))


@router.post("", status_code=HTTPStatus.CREATED, responses=responses(NoSuchRun, InvalidRequest))
def shares_create(
    session: SessionDependency, platform: PlatformDependency, viewer: EditorDependency, run_id: UUID, new: NewShare
) -> MadeShare:
    """Make a link by which anybody may look at this one run, until it expires. It is shown this once."""
    return service.create(session, platform.settings, viewer, run_id, new)


@router.delete(
    "/{share_id}", status_code=HTTPStatus.NO_CONTENT, responses=responses(NoSuchRun, NoSuchShare, InvalidRequest)
)
def shares_delete(session: SessionDependency, viewer: EditorDependency, run_id: UUID, share_id: UUID) -> None:
    """Take a link back at once."""
    service.delete(session, viewer, run_id, share_id)
