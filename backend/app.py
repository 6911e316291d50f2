"""The HTTP application: `uvicorn backend.app:create_app --factory`."""

import asyncio
import os
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import structlog
from fastapi import APIRouter, Depends, FastAPI
from sqlalchemy.exc import ProgrammingError
from starlette.types import Lifespan

from backend.administration.endpoints import router as administration
from backend.comparisons.endpoints import router as comparisons
from backend.experiments.endpoints import router as experiments
from backend.flow.endpoints import router as flow
from backend.forms.endpoints import router as forms
from backend.groups.endpoints import router as groups
from backend.health.endpoints import router as health
from backend.imports.endpoints import router as imports
from backend.operations.endpoints import router as operations
from backend.operations.measures import served
from backend.page import install as install_page
from backend.people.endpoints import account_router, invitations_router, people_router, session_router
from backend.people.service import ensure_local_people, ensure_local_secrets, has_administrator
from backend.planning.endpoints import router as planning
from backend.platform import problems
from backend.platform.asked_for import NamedRequests
from backend.platform.bodies import BoundedBodies
from backend.platform.database import make_engine, make_sessions
from backend.platform.dependencies import Platform
from backend.platform.entity_tags import TaggedAnswers
from backend.platform.events import Listener
from backend.platform.harmless import HarmlessAnswers
from backend.platform.kept import Kept
from backend.platform.logging import set_up_logging
from backend.platform.measures import Measured, Measures
from backend.platform.media import check_media
from backend.platform.object_store import ObjectStore
from backend.platform.openapi import document
from backend.platform.opening import ClosedUntilLookedAfter
from backend.platform.origins import LocalOnly, refuse_open_door
from backend.platform.queue import Queue
from backend.platform.rates import Rates
from backend.platform.settings import Settings, environment_settings
from backend.platform.stopping import before_stopping
from backend.platform.tracing import start_tracing, stop_tracing
from backend.presets.endpoints import router as presets
from backend.previews.endpoints import of_runs as detections
from backend.previews.endpoints import router as previews
from backend.quality.endpoints import router as quality
from backend.results.endpoints import router as results
from backend.runs.endpoints import router as runs
from backend.shares.endpoints import router as shares
from backend.stacks.endpoints import router as stacks
from backend.stacks.images import OpenStacks
from backend.tokens.endpoints import router as tokens
from backend.trajectories.endpoints import router as trajectories
from backend.trash.endpoints import router as trash
from backend.uploads.endpoints import router as uploads
from backend.uploads.intake import Intakes
from backend.webhooks.endpoints import router as webhooks
from dropflow.provenance import code_version

API = "/api/v1"
log = structlog.get_logger()


class NotMigrated(RuntimeError):
    """The database is not there, or not of the form that this version needs."""


def create_app(settings: Settings | None = None) -> FastAPI:
    """Make the application; its parts are started when it is served."""
    settings = settings or environment_settings()
    set_up_logging(settings.log_level)
    app = bare_app(_lifespan(settings))
    app.state.measures = Measures()
    app.add_middleware(TaggedAnswers)
    app.add_middleware(HarmlessAnswers)
    app.add_middleware(BoundedBodies, max_bytes=settings.max_body_bytes)
    if settings.auth == "local":
        refuse_open_door(sys.argv, os.environ)
        app.add_middleware(LocalOnly)
    else:
        app.add_middleware(ClosedUntilLookedAfter, is_looked_after=lambda: _is_looked_after(app.state.platform))
    app.add_middleware(Measured, measures=app.state.measures)
    app.add_middleware(NamedRequests)
    app.include_router(operations)
    install_page(app, settings.frontend_dist)
    start_tracing(settings.otel_exporter_otlp_endpoint, "dropflow-api", app)
    return app


def bare_app(lifespan: Lifespan[FastAPI] | None = None) -> FastAPI:
    """The endpoints without a place to run: what the OpenAPI document is made from."""
    app = FastAPI(
        title="Dropflow",
        version=code_version(),
        description="Sizes, paths and the flow field of polydisperse sedimenting droplets, from image stacks.",
        openapi_url=f"{API}/openapi.json",
        # FastAPI's pages of documentation load their scripts from a server elsewhere, which a lab may not reach.
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=lambda route: route.name,
        lifespan=lifespan,
    )
    api = APIRouter(prefix=API, dependencies=[Depends(check_media)])
    lab = (session_router, account_router, people_router, groups, invitations_router, webhooks, tokens, shares)
    films = (experiments, stacks, imports, trash, uploads, runs, results, trajectories, flow, quality, comparisons)
    aids = (planning, presets, previews, detections)
    for router in (health, forms, *lab, administration, *films, *aids):
        api.include_router(router)
    app.include_router(api)
    problems.install(app)
    app.openapi = lambda: document(app)  # type: ignore[method-assign]
    return app


def _lifespan(settings: Settings) -> Lifespan[FastAPI]:
    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        # The thread pool of synchronous endpoints has 40 threads; each may hold one connection.
        engine = make_engine(settings.database_url, application="dropflow-api", pool_size=10, max_overflow=30)
        platform = Platform(
            settings=settings,
            sessions=make_sessions(engine),
            store=ObjectStore(settings.object_store_url, settings.outside),
            queue=Queue(settings.redis_url),
            listener=Listener(settings.database_url),
            rates=Rates(settings.redis_url),
        )
        app.state.platform, app.state.open_stacks, app.state.intakes = platform, OpenStacks(), Intakes()
        app.state.kept = Kept()
        try:
            _greet(platform)
            platform.listener.start(asyncio.get_running_loop())
            with (
                served(settings.metrics_address, platform.sessions, platform.queue, app.state.measures),
                before_stopping(platform.listener.let_go),
            ):
                yield
        finally:
            platform.listener.stop()
            app.state.open_stacks.close()
            platform.queue.close()
            engine.dispose()
            stop_tracing()

    return lifespan


def _greet(platform: Platform) -> None:
    """Find the database in the form that this version needs, and somebody in it who looks after the service."""
    settings = platform.settings
    try:
        with platform.sessions.begin() as session:
            if settings.auth == "local":
                ensure_local_people(session)
                ensure_local_secrets(session, settings)
            elif not has_administrator(session):
                log.warning("closed until somebody looks after it", hint="dropflow-server administrator EMAIL")
    except ProgrammingError:
        raise NotMigrated("The database has not the tables of this version: run `alembic upgrade head`.") from None


def _is_looked_after(platform: Platform) -> bool:
    with platform.sessions.begin() as session:
        return has_administrator(session)
