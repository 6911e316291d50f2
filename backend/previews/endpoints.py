"""/experiments/{id}/previews and /suggestions."""

from uuid import UUID

from fastapi import APIRouter

from backend.experiments.errors import NoSuchExperiment
from backend.platform.dependencies import EditorDependency, PlatformDependency
from backend.platform.problems import InvalidRequest, responses
from backend.previews import service
from backend.previews.errors import PreviewFailed, PreviewLate
from backend.previews.schemas import LinkPreview, LinkWish, Preview, PreviewWish, Suggestions
from backend.stacks.errors import StackNotReady

router = APIRouter(prefix="/experiments/{experiment_id}", tags=["previews"])
_ERRORS = responses(NoSuchExperiment, StackNotReady, PreviewFailed, PreviewLate, InvalidRequest)


@router.post("/previews", responses=_ERRORS)
def previews_create(
    platform: PlatformDependency, viewer: EditorDependency, experiment_id: UUID, wish: PreviewWish
) -> Preview:
    """Try parameters on one frame: what is found, and what is not and why. Nothing is kept."""
    return service.droplets(platform, viewer, experiment_id, wish)


@router.post("/previews/links", responses=_ERRORS)
def link_previews_create(
    platform: PlatformDependency, viewer: EditorDependency, experiment_id: UUID, wish: LinkWish
) -> LinkPreview:
    """Try parameters on following droplets from a frame to the next. Nothing is kept."""
    return service.links(platform, viewer, experiment_id, wish)


@router.post("/suggestions", responses=_ERRORS)
def suggestions_create(platform: PlatformDependency, viewer: EditorDependency, experiment_id: UUID) -> Suggestions:
    """Measure noise, contrast, radii and displacement on a few frames, and propose parameters."""
    return service.suggestions(platform, viewer, experiment_id)
