"""`dropflow-server doctor`: looks at each part as the service would use it, and says what to mend."""

import secrets
import shutil
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import psycopg
import redis
from sqlalchemy import Engine, make_url, text
from sqlalchemy.exc import OperationalError, SQLAlchemyError

from backend.operations.measures import OLDEST_QUEUED_S
from backend.operations.migrated import newest_form
from backend.operations.tables import revision_of
from backend.platform.database import make_engine
from backend.platform.object_store import ObjectStore
from backend.platform.queue import QUEUES, make_celery
from backend.platform.reasons import reason_of
from backend.platform.settings import Settings

_LEAST_FREE = 0.05
"""Share of a disk that should be free."""
_MOST_CLOCK_DIFFERENCE_S = 5.0
_ANSWER_S = 2.0
_WAITING_S = 300.0
_CONNECTIONS = """
SELECT current_setting('max_connections')::int - current_setting('superuser_reserved_connections')::int,
       count(*) FILTER (WHERE backend_type = 'client backend'),
       count(*) FILTER (WHERE application_name = 'dropflow-events' AND datname = current_database())
FROM pg_stat_activity
"""
CONNECTIONS_OF_API, CONNECTIONS_OF_WORKER, CONNECTIONS_OF_PROCESS, CONNECTIONS_OF_OTHERS = 41, 4, 2, 15
"""At most: of an API process (its threads and its listener), the main process of a worker, each of its processes, and
two reconcilers and some commands."""
_QUERIES = (
    "SELECT count(*) FROM shard WHERE state = 'running' AND lease_until < clock_timestamp() - interval '1 minute'",
    OLDEST_QUEUED_S,
    "SELECT count(*) FROM run WHERE state = 'failed' AND finished_at > now() - interval '1 day'",
)


class Verdict(StrEnum):
    """How a part is."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"


@dataclass(frozen=True)
class Finding:
    """What was found of one part, and what to do if it is not good."""

    part: str
    verdict: Verdict
    found: str
    mend: str = ""

    def as_json(self) -> dict[str, str]:
        """The same with plain values."""
        return {name: str(value) for name, value in asdict(self).items()}


def examine(settings: Settings) -> Iterator[Finding]:
    """Findings of each part, as they are made. A part that cannot be reached is a finding, never an exception."""
    engine = make_engine(settings.database_url, application="dropflow-doctor")
    looks: dict[str, Callable[[], Finding]] = {
        "database": lambda: _database(engine, settings),
        "connections": lambda: _connections(engine, settings),
        "clock": lambda: _clock(engine),
        "queue": lambda: _queue(settings),
        "workers": lambda: _workers(settings),
        "work": lambda: _work(engine),
        "object store": lambda: _object_store(settings),
        "disks": lambda: _disks(settings),
        "page": lambda: _page(settings),
    }
    try:
        for part, look in looks.items():
            yield _looked(part, look)
    finally:
        engine.dispose()


def _looked(part: str, look: Callable[[], Finding]) -> Finding:
    try:
        return look()
    except SQLAlchemyError as problem:
        found, mend = reason_of(problem), "Is PostgreSQL up, and DATABASE_URL right?"
    except redis.RedisError as problem:
        found, mend = reason_of(problem), "Is Redis or Valkey up, and REDIS_URL right?"
    except Exception as problem:
        found, mend = f"{type(problem).__name__}: {reason_of(problem)}", "See what it says."
    return Finding(part, Verdict.BAD, found, mend)


def _database(engine: Engine, settings: Settings) -> Finding:
    encoding = _encoding(settings)
    if encoding != "UTF8":
        mend = "Make the database anew: CREATE DATABASE ... ENCODING 'UTF8' TEMPLATE template0."
        return Finding("database", Verdict.BAD, f"it keeps text as {encoding}, not UTF8", mend)
    with engine.connect() as connection:
        version = connection.exec_driver_sql("SHOW server_version").scalar()
        revision = revision_of(connection)
    head = newest_form()
    if revision == head:
        return Finding("database", Verdict.GOOD, f"PostgreSQL {version}, form {revision}")
    return Finding(
        "database",
        Verdict.BAD,
        f"PostgreSQL {version} has form {revision or 'none'}, this version needs {head}",
        "Run `dropflow-server migrate`, with the services of this version.",
    )


def _encoding(settings: Settings) -> str | None:
    """How the server keeps text, as it tells on connecting: SQLAlchemy itself fails where that is SQL_ASCII."""
    address = make_url(settings.database_url).set(drivername="postgresql").render_as_string(hide_password=False)
    try:
        with psycopg.connect(address, connect_timeout=5) as connection:
            return connection.info.parameter_status("server_encoding")
    except psycopg.OperationalError as problem:
        raise OperationalError(str(problem), None, problem) from None


def _connections(engine: Engine, settings: Settings) -> Finding:
    """Whether the server lets in all that could come at once, not only those who are there now."""
    with engine.connect() as connection:
        most, n_open, n_apis = connection.exec_driver_sql(_CONNECTIONS).one()
    n_needed = max(n_apis, 1) * CONNECTIONS_OF_API + CONNECTIONS_OF_OTHERS
    with make_celery(settings.redis_url) as celery:
        answers: dict[str, dict[str, Any]] = celery.control.inspect(timeout=_ANSWER_S).stats() or {}
    for worker in answers.values():
        n_needed += CONNECTIONS_OF_WORKER + CONNECTIONS_OF_PROCESS * int(worker["pool"]["max-concurrency"])
    found = f"{n_open} of {most} open; what runs may open {n_needed} ({n_apis} API, {len(answers)} workers)"
    if n_needed <= most:
        return Finding("connections", Verdict.GOOD, found)
    mend = f"Set max_connections of PostgreSQL to {n_needed} or more: in a composition POSTGRES_CONNECTIONS in .env."
    return Finding("connections", Verdict.DOUBTFUL, found, mend)


def _clock(engine: Engine) -> Finding:
    with engine.connect() as connection:
        theirs: datetime = connection.execute(text("SELECT clock_timestamp()")).scalar_one()
    difference_s = abs((datetime.now(UTC) - theirs).total_seconds())
    found = f"{difference_s:.1f} s from the database's"
    if difference_s < _MOST_CLOCK_DIFFERENCE_S:
        return Finding("clock", Verdict.GOOD, found)
    return Finding("clock", Verdict.DOUBTFUL, found, "Set the clocks by NTP: sign-ins and logs depend on them.")


def _queue(settings: Settings) -> Finding:
    with redis.Redis.from_url(settings.redis_url, socket_timeout=_ANSWER_S, socket_connect_timeout=_ANSWER_S) as broker:
        broker.ping()
        waiting = {queue: broker.llen(queue) for queue in QUEUES}
    found = "messages waiting: " + ", ".join(f"{queue} {n}" for queue, n in waiting.items())
    return Finding("queue", Verdict.GOOD, found)


def _workers(settings: Settings) -> Finding:
    with make_celery(settings.redis_url) as celery:
        answers: dict[str, list[dict[str, Any]]] = celery.control.inspect(timeout=_ANSWER_S).active_queues() or {}
    served = {queue: sum(queue in {q["name"] for q in queues} for queues in answers.values()) for queue in QUEUES}
    found = f"{len(answers)} answered: " + ", ".join(f"{queue} {n}" for queue, n in served.items())
    missing = [queue for queue, n in served.items() if not n]
    if not missing:
        return Finding("workers", Verdict.GOOD, found)
    mend = f"Start a worker for {', '.join(missing)}: celery --app worker.app worker --queues {','.join(missing)}"
    return Finding("workers", Verdict.BAD, found, mend)


def _work(engine: Engine) -> Finding:
    with engine.connect() as connection:
        expired, oldest_s, n_failed = (connection.execute(text(query)).scalar_one() for query in _QUERIES)
    if expired:
        found = f"{expired} shards whose worker is silent were given to nobody"
        return Finding("work", Verdict.BAD, found, "Start a reconciler: python -m worker.reconcile")
    found = f"oldest shard waits {float(oldest_s):.0f} s, {n_failed} runs failed in a day"
    if oldest_s > _WAITING_S:
        return Finding("work", Verdict.DOUBTFUL, found, "More workers would shorten that.")
    return Finding("work", Verdict.GOOD, found)


def _object_store(settings: Settings) -> Finding:
    store, key, content = (
        ObjectStore(settings.object_store_url, settings.outside),
        f"doctor/{secrets.token_hex(8)}",
        secrets.token_bytes(64),
    )
    store.put(key, content)
    try:
        is_same = store.read(key) == content
    finally:
        store.remove(key)
    where = urlparse(settings.object_store_url)
    found = f"{where.scheme}://{where.netloc}{where.path}: written, read, removed"
    if is_same:
        return Finding("object store", Verdict.GOOD, found)
    return Finding("object store", Verdict.BAD, "it returned other bytes than were written", "Do not use this store.")


def _disks(settings: Settings) -> Finding:
    folders = {"WORK_DIR": settings.work_dir}
    if settings.object_store_url.startswith("file://"):
        folders["OBJECT_STORE_URL"] = Path(unquote(urlparse(settings.object_store_url).path))
    found, verdict = [], Verdict.GOOD
    for name, folder in folders.items():
        folder.mkdir(parents=True, exist_ok=True)
        usage = shutil.disk_usage(folder)
        found.append(f"{name} {usage.free / 1e9:.0f} GB free")
        if usage.free < _LEAST_FREE * usage.total:
            verdict = Verdict.DOUBTFUL
    return Finding("disks", verdict, ", ".join(found), "" if verdict == Verdict.GOOD else "Make room, or add a disk.")


def _page(settings: Settings) -> Finding:
    if (settings.frontend_dist / "index.html").is_file():
        return Finding("page", Verdict.GOOD, "built")
    return Finding("page", Verdict.BAD, f"not in {settings.frontend_dist}", "Build it: npm --prefix frontend run build")
