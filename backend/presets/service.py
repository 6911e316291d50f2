"""What can be done with presets."""

from uuid import UUID

from sqlalchemy.orm import Session

from backend.groups import repository as groups
from backend.groups.service import group_for_new
from backend.models import Group, Preset
from backend.platform.audit import tell
from backend.platform.visibility import Viewer
from backend.presets import repository, schemas
from backend.presets.errors import NameTaken, NoSuchPreset, TooManyPresets
from backend.runs.service import read_parameters

MOST = 200


def presets(session: Session, viewer: Viewer, group_id: UUID) -> list[schemas.Preset]:
    """All presets of a group."""
    return [_shown(preset) for preset in repository.presets(session, group_for_new(session, viewer, group_id))]


def create(session: Session, viewer: Viewer, group_id: UUID, new: schemas.NewPreset) -> schemas.Preset:
    """Keep parameters under a new name."""
    group = _locked(session, viewer, group_id)
    if repository.by_name(session, group, new.name) is not None:
        raise NameTaken(new.name)
    if repository.n_presets(session, group) >= MOST:
        raise TooManyPresets(MOST)
    preset = Preset(group_id=group.id)
    session.add(preset)
    return _saved(session, viewer, preset, new)


def replace(
    session: Session, viewer: Viewer, group_id: UUID, preset_id: UUID, new: schemas.NewPreset
) -> schemas.Preset:
    """Give a preset another name or other parameters."""
    group = _locked(session, viewer, group_id)
    preset = _existing(session, group, preset_id)
    if repository.by_name(session, group, new.name) not in (None, preset):
        raise NameTaken(new.name)
    return _saved(session, viewer, preset, new)


def delete(session: Session, viewer: Viewer, group_id: UUID, preset_id: UUID) -> None:
    """Forget a preset. Runs that began with it keep their parameters."""
    preset = _existing(session, group_for_new(session, viewer, group_id), preset_id)
    tell(session, name=preset.name)
    session.delete(preset)


def _locked(session: Session, viewer: Viewer, group_id: UUID) -> Group:
    """The group, in which nobody else takes a name until this transaction ends."""
    group = group_for_new(session, viewer, group_id)
    groups.lock(session, group.id)
    return group


def _existing(session: Session, group: Group, preset_id: UUID) -> Preset:
    preset = repository.find(session, group, preset_id)
    if preset is None:
        raise NoSuchPreset
    return preset


def _saved(session: Session, viewer: Viewer, preset: Preset, new: schemas.NewPreset) -> schemas.Preset:
    preset.name, preset.parameters = new.name, read_parameters(new.parameters).model_dump(mode="json")
    preset.person_id = viewer.person_id
    session.flush()
    session.refresh(preset)
    tell(session, name=preset.name, preset_id=preset.id)
    return _shown(preset)


def _shown(preset: Preset) -> schemas.Preset:
    return schemas.Preset(
        id=preset.id,
        group_id=preset.group_id,
        name=preset.name,
        parameters=preset.parameters,
        saved_by=None if preset.person is None else preset.person.name,
        updated_at=preset.updated_at,
    )
