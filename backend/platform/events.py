"""What changed, told to whoever waits: Postgres carries it with the transaction that made the change."""

import asyncio
import threading
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any
from uuid import UUID

import psycopg
import structlog
from sqlalchemy import ColumnElement, func, make_url, select
from sqlalchemy.orm import Session

CHANNEL = "dropflow_changed"
_ALL = "*"
_LOOK_UP_S = 2.0
_NOTHING = ""
log = structlog.get_logger()


def run_topic(run_id: UUID) -> str:
    """Changes of one run."""
    return f"run:{run_id}"


def experiment_topic(experiment_id: UUID) -> str:
    """Changes of one experiment, its stack and the states of its runs."""
    return f"experiment:{experiment_id}"


def announce(session: Session, *topics: str) -> None:
    """Tell of a change when, and only if, this transaction commits."""
    if topics:
        session.execute(select(*announcing(*topics)))


def announcing(*topics: str) -> list[ColumnElement[Any]]:
    """The same as columns of a statement, which saves a way to the database."""
    return [func.pg_notify(CHANNEL, topic) for topic in topics]


class Listener:
    """One thread of the process listens; it wakes the asynchronous waiters of a topic and holds nothing else."""

    def __init__(self, database_url: str) -> None:
        self._conninfo = make_url(database_url).set(drivername="postgresql").render_as_string(hide_password=False)
        self._waiters: dict[str, set[asyncio.Event]] = defaultdict(set)
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread = threading.Thread(target=self._listen_for_ever, name="events", daemon=True)

    @property
    def is_stopping(self) -> bool:
        """Whether waiters should let go."""
        return self._stopping.is_set()

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begin to listen; waiters live on `loop`."""
        self._loop = loop
        self._thread.start()

    def let_go(self) -> None:
        """Wake every waiter for good."""
        self._stopping.set()
        self._wake(_ALL)

    def stop(self) -> None:
        """The same, and end the thread."""
        self.let_go()
        if not self._thread.is_alive():
            return
        with suppress(psycopg.OperationalError), psycopg.connect(self._conninfo, autocommit=True) as connection:
            connection.execute("SELECT pg_notify(%s, %s)", (CHANNEL, _NOTHING))  # wakes our own thread
        self._thread.join(timeout=5)

    @contextmanager
    def subscription(self, topic: str) -> Iterator[asyncio.Event]:
        """An event that is set whenever `topic` changed; the waiter clears it before it looks."""
        woken = asyncio.Event()
        with self._lock:
            self._waiters[topic].add(woken)
        try:
            yield woken
        finally:
            with self._lock:
                self._waiters[topic].discard(woken)
                if not self._waiters[topic]:
                    del self._waiters[topic]

    def _listen_for_ever(self) -> None:
        while not self._stopping.is_set():
            try:
                self._listen()
            except psycopg.OperationalError as problem:
                log.warning("events interrupted", reason=str(problem))
                self._stopping.wait(_LOOK_UP_S)

    def _listen(self) -> None:
        with psycopg.connect(self._conninfo, autocommit=True, application_name="dropflow-events") as connection:
            connection.execute(f"LISTEN {CHANNEL}")
            self._wake(_ALL)  # what was told while nobody listened is looked up by all
            while not self._stopping.is_set():
                for told in connection.notifies(timeout=_LOOK_UP_S, stop_after=1):
                    self._wake(told.payload)

    def _wake(self, topic: str) -> None:
        with self._lock:
            groups = list(self._waiters.values()) if topic == _ALL else [self._waiters.get(topic, set())]
            events = [event for group in groups for event in group]
        if self._loop is not None and not self._loop.is_closed():
            for event in events:
                self._loop.call_soon_threadsafe(event.set)
