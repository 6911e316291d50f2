"""What endpoints ask for: a transaction, whoever asks, and the parts of the running service."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from backend.platform.database import Sessions
from backend.platform.events import Listener
from backend.platform.object_store import ObjectStore
from backend.platform.queue import Queue
from backend.platform.settings import Settings
from backend.platform.visibility import LOCAL_VIEWER, Viewer


@dataclass(frozen=True)
class Platform:
    """The parts of a running service."""

    settings: Settings
    sessions: Sessions
    store: ObjectStore
    queue: Queue
    listener: Listener


def get_platform(request: Request) -> Platform:
    """The parts that the application was started with."""
    platform: Platform = request.app.state.platform
    return platform


def get_session(platform: Annotated[Platform, Depends(get_platform)]) -> Iterator[Session]:
    """One transaction a request, committed before the answer is sent."""
    with platform.sessions.begin() as session:
        yield session


def current_viewer() -> Viewer:
    """Whoever asks. On one machine (AUTH=local) that is its one person."""
    return LOCAL_VIEWER


PlatformDependency = Annotated[Platform, Depends(get_platform)]
SessionDependency = Annotated[Session, Depends(get_session, scope="function")]
ViewerDependency = Annotated[Viewer, Depends(current_viewer)]
