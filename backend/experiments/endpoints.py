"""/experiments."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse

from backend.experiments import service
from backend.experiments.errors import NoSuchExperiment, RunActive
from backend.experiments.schemas import (
    ChangeExperiment,
    Experiment,
    ExperimentQuery,
    Experiments,
    MoveExperiment,
    NewExperiment,
)
from backend.groups.errors import NoSuchGroup, QuotaExceeded
from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.entity_tags import ChangedMeanwhile, IfMatch, tag_of
from backend.platform.events import experiment_topic
from backend.platform.idempotency import KeyOfAnother, MadeAndDeleted, OnceDependency
from backend.platform.live import Changes, follow
from backend.platform.problems import InvalidRequest, responses

router = APIRouter(prefix="/experiments", tags=["experiments"])


@router.get("", responses=responses(InvalidRequest))
def experiments_list(
    session: SessionDependency, viewer: ViewerDependency, query: Annotated[ExperimentQuery, Query()]
) -> Experiments:
    """List experiments, newest first unless `sort` says otherwise."""
    return service.page(session, viewer, query)


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses=responses(NoSuchGroup, MadeAndDeleted, KeyOfAnother, InvalidRequest),
)
def experiments_create(
    session: SessionDependency, viewer: EditorDependency, once: OnceDependency, new: NewExperiment
) -> Experiment:
    """Describe what was filmed. Its frames are uploaded next."""
    made = once.create(
        lambda: service.create(session, viewer, new.experiment, new.group_id),
        lambda experiment_id: service.get(session, viewer, experiment_id),
    )
    return service.shown(session, viewer, made)


def _tagged(answer: Response, shown: Experiment) -> Experiment:
    answer.headers["ETag"] = tag_of(shown.experiment, shown)
    return shown


@router.get("/{experiment_id}", responses=responses(NoSuchExperiment, InvalidRequest))
def experiments_get(
    session: SessionDependency, viewer: ViewerDependency, experiment_id: UUID, answer: Response
) -> Experiment:
    """Look at one experiment."""
    return _tagged(answer, service.shown(session, viewer, service.get(session, viewer, experiment_id)))


@router.patch("/{experiment_id}", responses=responses(NoSuchExperiment, RunActive, ChangedMeanwhile, InvalidRequest))
def experiments_update(
    session: SessionDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    change: ChangeExperiment,
    answer: Response,
    if_match: IfMatch = None,
) -> Experiment:
    """Replace the description. Refused while a run goes on; finished runs keep the description they were made with."""
    changed = service.change(session, viewer, experiment_id, change.experiment, if_match)
    return _tagged(answer, service.shown(session, viewer, changed))


@router.put("/{experiment_id}/group", responses=responses(NoSuchExperiment, NoSuchGroup, QuotaExceeded, InvalidRequest))
def experiments_move(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    move: MoveExperiment,
) -> Experiment:
    """Let an experiment, with its runs, belong to another group. You need the right to edit in both."""
    moved = service.move(session, platform.settings, viewer, experiment_id, move.group_id)
    return service.shown(session, viewer, moved)


@router.delete(
    "/{experiment_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchExperiment, RunActive, InvalidRequest),
)
def experiments_delete(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    experiment_id: UUID,
    forever: Annotated[bool, Query(description="Remove it for good, past the trash.")] = False,
) -> None:
    """Put an experiment into the trash, with its frames, runs and results."""
    service.delete(session, platform, viewer, experiment_id, is_forever=forever)


async def _existing_experiment(platform: PlatformDependency, viewer: ViewerDependency, experiment_id: UUID) -> UUID:
    """Answer 404 before a stream begins; no transaction stays open for it."""
    await run_in_threadpool(service.look, platform, viewer, experiment_id)
    return experiment_id


@router.get(
    "/{experiment_id}/events",
    response_class=EventSourceResponse,
    responses=responses(NoSuchExperiment, InvalidRequest),
)
async def experiments_events(
    platform: PlatformDependency,
    viewer: ViewerDependency,
    experiment_id: Annotated[UUID, Depends(_existing_experiment)],
) -> Changes:
    """Follow an experiment: `changed` with the experiment as it is now, at once and after every change."""
    async for event in follow(
        platform.listener, experiment_topic(experiment_id), lambda: service.look(platform, viewer, experiment_id)
    ):
        yield event
