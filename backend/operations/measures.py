"""Measures for Prometheus: of this process as it goes, and of the whole service out of the database when asked.

They are served on a port of their own (METRICS_ADDRESS), which no proxy passes on.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import structlog
from prometheus_client import CollectorRegistry, start_http_server
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from redis.exceptions import RedisError
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from backend.platform.database import Sessions
from backend.platform.measures import Measures
from backend.platform.queue import QUEUES, Queue
from backend.platform.reasons import reason_of

_RECENTLY = "5 minutes"
log = structlog.get_logger()

_RUNS = "SELECT state, count(*) FROM run GROUP BY state"
_SHARDS = "SELECT task, state, count(*) FROM shard WHERE state IN ('queued', 'running') GROUP BY task, state"
_RECENT = f"""
SELECT task, sum(done_frames), sum(extract(epoch FROM finished_at - started_at)), count(*),
       percentile_cont(0.95) WITHIN GROUP (ORDER BY extract(epoch FROM finished_at - started_at))
FROM shard WHERE state = 'completed' AND NOT is_reused AND finished_at > now() - interval '{_RECENTLY}' GROUP BY task
"""  # noqa: S608 - our own interval
_HOLDERS = "SELECT count(DISTINCT holder) FROM shard WHERE state = 'running'"
OLDEST_QUEUED_S = """
SELECT coalesce(extract(epoch FROM clock_timestamp() - min(greatest(created_at, sent_at))), 0)
FROM shard WHERE state = 'queued'
"""
_TALLIES = "SELECT name, count FROM tally"


class ServiceCollector(Collector):
    """The state of the whole service; every API process gives the same, so take the maximum over them."""

    def __init__(self, sessions: Sessions, queue: Queue) -> None:
        self._sessions, self._queue = sessions, queue

    def describe(self) -> Iterable[Metric]:
        """Nothing: to register is not to ask the database."""
        return ()

    def collect(self) -> Iterator[Metric]:
        """Ask database and queue; a part that is away is missing, and `dropflow_up` says which."""
        up = GaugeMetricFamily("dropflow_up", "Whether a part answers.", labels=["part"])
        for part, ask in (("database", self._of_database), ("queue", self._of_queue)):
            try:
                found = list(ask())
            except (SQLAlchemyError, RedisError, OSError) as problem:
                log.warning("not measured", part=part, reason=reason_of(problem))
                up.add_metric([part], 0)
                continue
            up.add_metric([part], 1)
            yield from found
        yield up

    def _of_queue(self) -> Iterator[Metric]:
        depth = GaugeMetricFamily("dropflow_queue_depth", "Messages that no worker has taken.", labels=["queue"])
        for queue in QUEUES:
            depth.add_metric([queue], self._queue.n_waiting(queue))
        yield depth

    def _of_database(self) -> Iterator[Metric]:
        with self._sessions() as session:
            rows = {
                name: session.execute(text(query)).all()
                for name, query in (("runs", _RUNS), ("shards", _SHARDS), ("recent", _RECENT), ("tallies", _TALLIES))
            }
            n_holders = session.execute(text(_HOLDERS)).scalar_one()
            oldest_s = session.execute(text(OLDEST_QUEUED_S)).scalar_one()
        runs = GaugeMetricFamily("dropflow_runs", "Runs by state.", labels=["state"])
        for state, n in rows["runs"]:
            runs.add_metric([state], n)
        shards = GaugeMetricFamily("dropflow_shards", "Shards that are to be done.", labels=["task", "state"])
        for task, state, n in rows["shards"]:
            shards.add_metric([task, state], n)
        yield from (runs, shards, *_recent(rows["recent"]))
        expired = CounterMetricFamily("dropflow_lease_expiries", "Shards whose worker fell silent.")
        expired.add_metric([], {str(name): n for name, n in rows["tallies"]}.get("lease_expiries", 0))
        yield expired
        yield GaugeMetricFamily("dropflow_busy_workers", "Worker processes that hold a shard.", value=n_holders)
        yield GaugeMetricFamily("dropflow_oldest_queued_seconds", "Since the oldest was told of.", value=oldest_s)


def _recent(rows: Iterable[Any]) -> Iterator[Metric]:
    frames = GaugeMetricFamily(
        "dropflow_frames_per_second", "Frames done, over the last 5 minutes, by all workers.", labels=["task"]
    )
    mean = GaugeMetricFamily(
        "dropflow_shard_seconds", "What a shard took on average, of those done in 5 minutes.", labels=["task"]
    )
    late = GaugeMetricFamily("dropflow_shard_seconds_p95", "The same that 95 % do not exceed.", labels=["task"])
    for task, n_frames, seconds, n_shards, p95 in rows:
        frames.add_metric([task], float(n_frames) / 300.0)
        mean.add_metric([task], float(seconds) / n_shards)
        late.add_metric([task], float(p95))
    yield from (frames, mean, late)


@contextmanager
def served(address: str | None, sessions: Sessions, queue: Queue, measures: Measures) -> Iterator[None]:
    """Serve all measures on `address` (host:port) meanwhile; without one, nothing is served."""
    if address is None:
        yield
        return
    registry: CollectorRegistry = measures.registry
    registry.register(ServiceCollector(sessions, queue))
    host, _, port = address.rpartition(":")
    server, thread = start_http_server(int(port), host.strip("[]"), registry)
    try:
        yield
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
