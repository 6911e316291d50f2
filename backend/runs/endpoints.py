"""/experiments/{id}/runs and /runs."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse

from backend.experiments.errors import NoSuchExperiment
from backend.models.states import RUN_RULES, is_terminal
from backend.platform.dependencies import EditorDependency, PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.events import run_topic
from backend.platform.idempotency import KeyOfAnother, OnceDependency
from backend.platform.live import Changes, follow
from backend.platform.problems import InvalidRequest, responses
from backend.runs import service
from backend.runs.errors import NoSuchRun, RunActive, RunFinished, RunNotFailed
from backend.runs.schemas import NewRun, Reuse, Run, RunQuery, Runs
from backend.stacks.errors import StackNotReady

router = APIRouter(tags=["runs"])


@router.get("/experiments/{experiment_id}/runs", responses=responses(NoSuchExperiment, InvalidRequest))
def runs_list(
    session: SessionDependency, viewer: ViewerDependency, experiment_id: UUID, query: Annotated[RunQuery, Query()]
) -> Runs:
    """List the runs of an experiment, newest first unless `sort` says otherwise."""
    return service.page(session, viewer, query, experiment_id)


@router.get("/runs", responses=responses(InvalidRequest))
def runs_list_all(session: SessionDependency, viewer: ViewerDependency, query: Annotated[RunQuery, Query()]) -> Runs:
    """List the runs of all experiments, newest first unless `sort` says otherwise."""
    return service.page(session, viewer, query)


@router.post(
    "/experiments/{experiment_id}/runs",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(NoSuchExperiment, StackNotReady, KeyOfAnother, InvalidRequest),
)
def runs_create(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    once: OnceDependency,
    experiment_id: UUID,
    new: NewRun,
) -> Run:
    """Analyse an experiment. Stages whose input is that of an earlier run are taken from it."""
    made = once.create(
        lambda: service.create(session, platform, viewer, experiment_id, new.parameters),
        lambda run_id: service.get(session, viewer, run_id),
    )
    return service.shown(session, made)


@router.get("/runs/{run_id}", responses=responses(NoSuchRun, InvalidRequest))
def runs_get(session: SessionDependency, viewer: ViewerDependency, run_id: UUID) -> Run:
    """Look at one run."""
    return service.shown(session, service.get(session, viewer, run_id))


@router.get("/runs/{run_id}/reuse", responses=responses(NoSuchRun, InvalidRequest))
def runs_get_reuse(session: SessionDependency, viewer: ViewerDependency, run_id: UUID) -> Reuse:
    """Look at what a run took over from earlier ones, and why the rest was done anew."""
    return service.reuse(session, viewer, run_id)


@router.post(
    "/runs/{run_id}/cancel",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(NoSuchRun, RunFinished, InvalidRequest),
)
def runs_cancel(session: SessionDependency, viewer: EditorDependency, run_id: UUID) -> Run:
    """Stop a run. It is `cancelled`, and what it made removed, as soon as nobody works on it any more."""
    return service.shown(session, service.cancel(session, viewer, run_id))


@router.post(
    "/runs/{run_id}/retry",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(NoSuchRun, RunNotFailed, KeyOfAnother, InvalidRequest),
)
def runs_retry(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    once: OnceDependency,
    run_id: UUID,
) -> Run:
    """Try a failed run again as a new run, which is answered. What had been done is not done again."""
    made = once.create(
        lambda: service.retry(session, platform, viewer, run_id), lambda made_id: service.get(session, viewer, made_id)
    )
    return service.shown(session, made)


@router.delete(
    "/runs/{run_id}", status_code=HTTPStatus.NO_CONTENT, responses=responses(NoSuchRun, RunActive, InvalidRequest)
)
def runs_delete(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: EditorDependency,
    run_id: UUID,
    forever: Annotated[bool, Query(description="Remove it for good, past the trash.")] = False,
) -> None:
    """Put a run that ended into the trash, with its results."""
    service.delete(session, platform, viewer, run_id, is_forever=forever)


async def _existing_run(platform: PlatformDependency, viewer: ViewerDependency, run_id: UUID) -> UUID:
    """Answer 404 before a stream begins; no transaction stays open for it."""
    await run_in_threadpool(service.look, platform, viewer, run_id)
    return run_id


@router.get("/runs/{run_id}/events", response_class=EventSourceResponse, responses=responses(NoSuchRun, InvalidRequest))
async def runs_events(
    platform: PlatformDependency, viewer: ViewerDependency, run_id: Annotated[UUID, Depends(_existing_run)]
) -> Changes:
    """Follow a run: `changed` with the run as it is now, at once and after every change, until it has ended."""
    async for event in follow(
        platform.listener,
        run_topic(run_id),
        lambda: service.look(platform, viewer, run_id),
        lambda run: is_terminal(RUN_RULES, run.state),
    ):
        yield event
