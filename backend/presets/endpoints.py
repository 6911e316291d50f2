"""/groups/{id}/presets."""

from http import HTTPStatus
from uuid import UUID

from fastapi import APIRouter

from backend.groups.errors import NoSuchGroup
from backend.platform.dependencies import EditorDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.presets import service
from backend.presets.errors import NameTaken, NoSuchPreset, TooManyPresets
from backend.presets.schemas import NewPreset, Preset, Presets

router = APIRouter(prefix="/groups/{group_id}/presets", tags=["presets"])


@router.get("", responses=responses(NoSuchGroup, InvalidRequest))
def presets_list(session: SessionDependency, viewer: ViewerDependency, group_id: UUID) -> Presets:
    """List the parameters that a group keeps under a name."""
    return Presets(items=service.presets(session, viewer, group_id))


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses=responses(NoSuchGroup, NameTaken, TooManyPresets, InvalidRequest),
)
def presets_create(session: SessionDependency, viewer: EditorDependency, group_id: UUID, new: NewPreset) -> Preset:
    """Keep parameters under a name, for everybody in the group."""
    return service.create(session, viewer, group_id, new)


@router.put("/{preset_id}", responses=responses(NoSuchGroup, NoSuchPreset, NameTaken, InvalidRequest))
def presets_update(
    session: SessionDependency, viewer: EditorDependency, group_id: UUID, preset_id: UUID, new: NewPreset
) -> Preset:
    """Give a preset another name or other parameters. Runs that began with it keep theirs."""
    return service.replace(session, viewer, group_id, preset_id, new)


@router.delete(
    "/{preset_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchGroup, NoSuchPreset, InvalidRequest),
)
def presets_delete(session: SessionDependency, viewer: EditorDependency, group_id: UUID, preset_id: UUID) -> None:
    """Forget a preset. Runs that began with it keep their parameters."""
    service.delete(session, viewer, group_id, preset_id)
