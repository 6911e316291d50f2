"""/experiments/{id}/previews and /suggestions, and the same look at a frame of a run."""

from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query, Response

from backend.experiments.errors import NoSuchExperiment
from backend.platform.dependencies import EditorDependency, PlatformDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.platform.rates import TooOften
from backend.previews import service
from backend.previews.errors import PreviewFailed, PreviewLate
from backend.previews.schemas import LinkPreview, LinkWish, Preview, PreviewWish, Suggestions
from backend.results.endpoints import FrameNumber
from backend.runs.errors import NoSuchRun
from backend.stacks.errors import StackNotReady

router = APIRouter(prefix="/experiments/{experiment_id}", tags=["previews"])
of_runs = APIRouter(prefix="/runs/{run_id}", tags=["results"])
_ERRORS = responses(NoSuchExperiment, StackNotReady, PreviewFailed, PreviewLate, TooOften, InvalidRequest)


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


@of_runs.get(
    "/frames/{frame}/detection",
    responses=responses(NoSuchRun, StackNotReady, PreviewFailed, PreviewLate, TooOften, InvalidRequest),
)
def detections_get(
    platform: PlatformDependency,
    viewer: ViewerDependency,
    run_id: UUID,
    frame: FrameNumber,
    is_picture_wanted: Annotated[bool, Query(description="Also answer the frame as detection sees it.")] = False,
) -> Preview:
    """Look once more at a frame as the run did: what was found, and what was not taken for a droplet and why."""
    return service.of_run(platform, viewer, run_id, frame, is_picture_wanted=is_picture_wanted)


@of_runs.get(
    "/frames/{frame}/prepared.jpg",
    response_class=Response,
    responses={
        200: {"content": {"image/jpeg": {}}, "description": "The frame, all of its pixels."},
        **responses(NoSuchRun, StackNotReady, PreviewFailed, PreviewLate, TooOften, InvalidRequest),
    },
)
def prepared_frames_get(
    platform: PlatformDependency, viewer: ViewerDependency, run_id: UUID, frame: FrameNumber
) -> Response:
    """Get a frame as the detection of a run saw it: its background even, its stripes and noise taken away."""
    # Frames and parameters of a run never change.
    headers = {"Cache-Control": "private, max-age=31536000, immutable"}
    return Response(service.prepared(platform, viewer, run_id, frame), media_type="image/jpeg", headers=headers)
