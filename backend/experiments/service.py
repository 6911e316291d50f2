"""What can be done with experiments."""

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn
from uuid import UUID

from sqlalchemy.orm import Session

from backend.experiments import repository, schemas
from backend.experiments.errors import DescribesFiles, NoSuchExperiment, RunActive, StackIndexing
from backend.groups import quotas
from backend.groups.schemas import Group
from backend.groups.service import group_for_new
from backend.models import Experiment, Import, Run, Stack
from backend.models.states import StackState
from backend.platform.audit import tell
from backend.platform.confirmed import facts_of
from backend.platform.dependencies import Platform
from backend.platform.entity_tags import check_unchanged
from backend.platform.events import announce, experiment_topic
from backend.platform.problems import Problem
from backend.platform.settings import Settings
from backend.platform.texts import unstorable
from backend.platform.trash import bytes_of_experiment, remove_experiment, throw_away
from backend.platform.visibility import MayNot, Viewer
from backend.runs import repository as runs_repository
from backend.runs.progress import shown_stages
from backend.runs.repository import Done
from dropflow.errors import ExperimentError
from dropflow.experiment import Experiment as Document
from dropflow.experiment import parse_experiment
from dropflow.physics.over_time import check_material

_SAYS_HOW_TO_UNDERSTAND = {
    "name",
    "pixel_size_um",
    "frame_interval_s",
    "droplets",
    "up",
    "phase",
    "material",
    "observation_depth_um",
    "recorded_at",
    "notes",
    "tags",
}
"""These can be corrected at any time. All other fields say how files are to be read, and that was done."""


def get(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    """One experiment."""
    return repository.find(session, viewer, experiment_id) or _absent(session, viewer, experiment_id)


def get_locked(session: Session, viewer: Viewer, experiment_id: UUID) -> Experiment:
    """One experiment that nobody else changes until this transaction ends."""
    return repository.lock(session, viewer, experiment_id) or _absent(session, viewer, experiment_id)


def page(session: Session, viewer: Viewer, query: schemas.ExperimentQuery) -> schemas.Experiments:
    """One page of experiments."""
    found, next_cursor = repository.page(session, viewer, query)
    return schemas.Experiments(items=shown_as(session, viewer, found), next_cursor=next_cursor)


def create(session: Session, viewer: Viewer, document: dict[str, Any], group_id: UUID | None) -> Experiment:
    """Make an experiment with an empty stack."""
    parsed = read_document(document)
    group = group_for_new(session, viewer, group_id)
    experiment = Experiment(group=group, document=parsed.model_dump(mode="json"), stack=Stack())
    session.add(experiment)
    session.flush()
    session.refresh(experiment)
    tell(session, experiment_id=experiment.id, name=parsed.name, group=group.name)
    return experiment


def change(
    session: Session, viewer: Viewer, experiment_id: UUID, document: dict[str, Any], if_match: str | None = None
) -> Experiment:
    """Replace the document, unless something is being made from it or another person changed it meanwhile."""
    parsed = read_document(document)
    experiment = get_locked(session, viewer, experiment_id)
    check_unchanged(if_match, experiment.document)
    if experiment.stack.state == StackState.INDEXING:
        raise StackIndexing
    refuse_during_run(session, experiment, "changed")
    if experiment.stack.state == StackState.READY:
        _correct(experiment.stack, parse_experiment(experiment.document), parsed)
    experiment.document = parsed.model_dump(mode="json")
    announce(session, experiment_topic(experiment.id))
    session.flush()
    session.refresh(experiment)
    return experiment


def delete(
    session: Session, platform: Platform, viewer: Viewer, experiment_id: UUID, *, is_forever: bool = False
) -> None:
    """Put an experiment with its frames, runs and results into the trash, or remove it for good."""
    experiment = get_locked(session, viewer, experiment_id)
    refuse_during_run(session, experiment, "deleted")
    tell(session, name=experiment.document["name"])
    if is_forever:
        remove_experiment(session, experiment)
    else:
        throw_away(session, viewer, experiment, bytes_of_experiment(platform.store, experiment))
    announce(session, experiment_topic(experiment.id))


def move(session: Session, settings: Settings, viewer: Viewer, experiment_id: UUID, group_id: UUID) -> Experiment:
    """Let an experiment belong to another group, if there is room for it. Links to its runs stay as they are."""
    experiment = get_locked(session, viewer, experiment_id)
    before, after = experiment.group, group_for_new(session, viewer, group_id)
    if after.id == before.id:
        return experiment
    quotas.demand_room(session, settings, after, quotas.bytes_of(session, experiment.id))
    experiment.group = after
    announce(session, experiment_topic(experiment.id))
    session.flush()
    session.refresh(experiment)
    tell(session, name=experiment.document["name"], from_group=before.name, to_group=after.name)
    return experiment


def read_document(content: dict[str, Any]) -> Document:
    """Validate what was sent, down to the name of the material."""
    problems = list(unstorable(content))
    if problems:
        raise ExperimentError("Please correct:", fields=problems)
    document = parse_experiment(content)
    check_material(document)
    return document


def shown_as(session: Session, viewer: Viewer, experiments: Sequence[Experiment]) -> list[schemas.Experiment]:
    """Experiments as the API shows them; a few queries for any number."""
    ids = [experiment.id for experiment in experiments]
    files = repository.files_of(session, ids)
    n_runs = runs_repository.n_runs(session, viewer, ids)
    latest = runs_repository.latest(session, viewer, ids)
    done = runs_repository.done_frames(session, [run.id for run in latest.values()])
    indexed = repository.indexed_frames(session, ids)
    imports = repository.open_imports(session, ids)
    return [
        schemas.Experiment(
            id=experiment.id,
            group=Group.model_validate(experiment.group),
            experiment=experiment.document,
            created_at=experiment.created_at,
            updated_at=experiment.updated_at,
            stack=_shown_stack(
                experiment,
                files.get(experiment.id, (0, 0)),
                indexed.get(experiment.id),
                imports.get(experiment.id),
            ),
            n_runs=n_runs.get(experiment.id, 0),
            latest_run=_shown_run(latest[experiment.id], done) if experiment.id in latest else None,
        )
        for experiment in experiments
    ]


def shown(session: Session, viewer: Viewer, experiment: Experiment) -> schemas.Experiment:
    """One experiment as the API shows it."""
    return shown_as(session, viewer, [experiment])[0]


def look(platform: Platform, viewer: Viewer, experiment_id: UUID) -> schemas.Experiment:
    """One experiment, looked up in a transaction of its own."""
    with platform.sessions.begin() as session:
        return shown(session, viewer, get(session, viewer, experiment_id))


def _correct(stack: Stack, before: Document, after: Document) -> None:
    """What a corrected document means for a stack that was read with the one before."""
    changed = {field for field in Document.model_fields if getattr(before, field) != getattr(after, field)}
    if changed - _SAYS_HOW_TO_UNDERSTAND:
        raise DescribesFiles(sorted(changed - _SAYS_HOW_TO_UNDERSTAND))
    if before.frame_interval_s and after.frame_interval_s and stack.duration_s is not None:
        stack.duration_s *= after.frame_interval_s / before.frame_interval_s  # with the gaps that are in it


def _shown_stack(
    experiment: Experiment, files: tuple[int, int], done_frames: int | None, importing: Import | None
) -> schemas.Stack:
    stack = experiment.stack
    return schemas.Stack(
        state=stack.state,
        n_files=files[0],
        size_bytes=files[1],
        n_frames=stack.n_frames,
        rows=stack.rows,
        columns=stack.columns,
        dtype=stack.dtype,
        duration_s=stack.duration_s,
        checksum=stack.checksum,
        done_frames=done_frames,
        importing=schemas.Importing.model_validate(importing) if importing else None,
        problem=Problem.model_validate(stack.problem) if stack.problem else None,
        warnings=stack.warnings,
        broken_frames=stack.broken_frames,
        confirmation=_shown_confirmation(experiment),
    )


def _shown_confirmation(experiment: Experiment) -> schemas.Confirmation | None:
    """Only of what is still as it was confirmed."""
    stack = experiment.stack
    if stack.confirmation is None or stack.confirmed_at is None or stack.confirmation["facts"] != facts_of(experiment):
        return None
    return schemas.Confirmation(by=stack.confirmation["by"], at=stack.confirmed_at)


def _shown_run(run: Run, done: Mapping[tuple[UUID, str], Done]) -> schemas.RunSummary:
    return schemas.RunSummary(
        id=run.id,
        number=run.number,
        state=run.state,
        created_at=run.created_at,
        finished_at=run.finished_at,
        stages=shown_stages(run, done),
        n_droplets=(run.summary or {}).get("detected", {}).get("n_droplets"),
    )


def _absent(session: Session, viewer: Viewer, experiment_id: UUID) -> NoReturn:
    """Refuse what somebody sees and may not do with it; what they do not see is not there."""
    if repository.find(session, viewer.only_looking(), experiment_id) is not None:
        raise MayNot(viewer.needs)
    raise NoSuchExperiment


def refuse_during_run(session: Session, experiment: Experiment, doing: str) -> None:
    """Raise `RunActive` where workers need the experiment as it is."""
    if repository.has_active_run(session, experiment.id):
        raise RunActive(doing)
