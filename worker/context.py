"""The parts that a worker process works with, made in the process itself: none of them survives a fork."""

import os
import socket
from dataclasses import dataclass
from functools import cache

from sqlalchemy import Engine

from backend.platform.database import Sessions, make_engine, make_sessions
from backend.platform.object_store import ObjectStore
from backend.platform.queue import Queue
from backend.platform.settings import Settings, environment_settings

_MAIN_PROCESS = f"{socket.gethostname()}:{os.getpid()}"


@dataclass(frozen=True)
class Context:
    """Where work is found and where it goes."""

    settings: Settings
    sessions: Sessions
    store: ObjectStore
    queue: Queue
    holder: str
    """Who holds what this process claims: machine, main process, this process."""
    engine: Engine

    @property
    def machine(self) -> str:
        """Where this process runs, and the folder that it works in is."""
        return self.holder.partition(":")[0]

    def close(self) -> None:
        """Let go of database and broker."""
        self.queue.close()
        self.engine.dispose()


def make_context(settings: Settings) -> Context:
    """The parts for one process."""
    engine = make_engine(settings.database_url, application="dropflow-worker", pool_size=2)
    return Context(
        settings=settings,
        sessions=make_sessions(engine),
        store=ObjectStore(settings.object_store_url, settings.outside),
        queue=Queue(settings.redis_url),
        holder=f"{_MAIN_PROCESS}:{os.getpid()}",
        engine=engine,
    )


@cache
def process_context() -> Context:
    """The parts of this process."""
    return make_context(environment_settings())


os.register_at_fork(after_in_child=process_context.cache_clear)


def holders_of_this_worker() -> str:
    """A pattern (SQL LIKE) of the holders of this main process and its children."""
    return f"{_MAIN_PROCESS}:%"
