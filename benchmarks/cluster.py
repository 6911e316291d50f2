"""How far database and queue carry: workers that sleep instead of computing, on real tables of a large laboratory.

    python -m benchmarks.cluster [--workers 200] [--hosts 5] [--runs 100] [--frames 20000] [--seconds 100]
                                 [--shard-s 20]

Every worker has its own connections and does what a real one does: it takes a message from Valkey, claims in Postgres,
says after each frame how far it is, and publishes; a reconciler runs beside. Only the computing is slept. Workers are
threads of a few processes (a process each would be 8 GB). With --hosts the processes run in network namespaces (needs
root), and Postgres and Valkey are reached over a bridge. A shard takes 20 s on average; --shard-s 2 stands for ten
times as many workers.

A claim is what passes from a worker's looking for work until it may begin; to publish is what passes after the work.
All of it runs on this machine: where its cores are busy (printed), these times are of waiting for a core.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from uuid import UUID, uuid4

from sqlalchemy import Connection, create_engine, insert, text
from sqlalchemy.orm import Session

from backend.models import Experiment, Group, Person, Run, Shard, Stack, Stage
from backend.platform.queue import Queue
from backend.platform.settings import with_driver
from benchmarks.hosts import Network, network
from benchmarks.processors import machine_s, spent_s
from deploy.local.postgres import Postgres, new_password
from deploy.local.processes import start
from deploy.local.services import ONE_THREAD
from deploy.local.valkey import Valkey
from tests.films import EXPERIMENT, PARAMETERS
from tests.services import MIGRATED, ROOT, migrate

FRAMES_PER_SHARD = 50
PEOPLE = 10
MESSAGES = 5000
"""Sent at once; when they are used up, the reconciler sends more, as after a queue was lost."""
_START_S = 240.0
_SIZE = """
SELECT pg_total_relation_size(oid), (xpath('/row/n/text()', query_to_xml('SELECT count(*) AS n FROM ' || relname,
       false, true, '')))[1]::text::bigint FROM pg_class WHERE relname = :name AND relkind = 'r'
"""
TABLES = ("shard", "product", "frame_summary", "run")


@dataclass(frozen=True)
class Servers:
    """Where the workers find what they work with."""

    database_url: str
    redis_url: str
    folder: Path
    pids: tuple[int, ...] = ()
    """Of Postgres and Valkey."""

    def environment(self, **more: str) -> dict[str, str]:
        """The settings of a process."""
        return {
            **os.environ, **ONE_THREAD,
            "DATABASE_URL": self.database_url,
            "REDIS_URL": self.redis_url,
            "OBJECT_STORE_URL": (self.folder / "objects").as_uri(),
            "WORK_DIR": str(self.folder / "work"),
            "LOG_LEVEL": "WARNING",
            "REMAP_SIGTERM": "SIGQUIT",
            **more,
        }  # fmt: skip


def fill(session: Session, *, n_runs: int, n_frames: int) -> None:
    """People with runs that all wait."""
    people = [Person(name=f"person {i}") for i in range(PEOPLE)]
    group = Group(name="laboratory")
    session.add_all([*people, group])
    session.flush()
    for number in range(n_runs):
        person = people[number % PEOPLE]
        experiment = Experiment(group_id=group.id, document=EXPERIMENT)
        experiment.stack = Stack(n_frames=n_frames, rows=2058, columns=2448, dtype="uint8")
        session.add(experiment)
        session.flush()
        run = Run(
            experiment_id=experiment.id,
            number=1,
            parameters=PARAMETERS,
            document=EXPERIMENT,
            version="benchmark",
            person_id=person.id,
        )
        run.stages = [
            Stage(name=name, position=position, total_frames=n_frames)
            for position, name in enumerate(("detect", "track", "analyse"))
        ]
        session.add(run)
        session.flush()
        session.execute(insert(Shard), list(shard_rows(experiment.id, run.id, person.id, n_frames)))


def shard_rows(experiment_id: UUID, run_id: UUID, person_id: UUID, n_frames: int) -> list[dict[str, object]]:
    return [
        {
            "id": uuid4(),
            "experiment_id": experiment_id,
            "run_id": run_id,
            "person_id": person_id,
            "task": "detect",
            "start_frame": start_frame,
            "stop_frame": min(start_frame + FRAMES_PER_SHARD, n_frames),
            "input_key": uuid4().hex,
        }
        for start_frame in range(0, n_frames, FRAMES_PER_SHARD)
    ]


@contextmanager
def servers(net: Network, folder: Path, n_workers: int) -> Iterator[Servers]:
    """Postgres and Valkey as a deployment has them: every commit is on the disk before it counts."""
    postgres = Postgres(
        folder / "postgres",
        password=new_password(),
        log=folder / "postgres.log",
        max_connections=3 * n_workers + 60,
        address=net.address,
    )
    valkey = Valkey(folder / "valkey", password=new_password(), log=folder / "valkey.log", address=net.address)
    with ExitStack() as stack:
        children = [server.start() for server in (postgres, valkey)]
        for child in children:
            stack.callback(child.stop)
        postgres.create_database(MIGRATED)
        migrate(postgres.url(MIGRATED))
        pids = tuple(child.process.pid for child in children)
        yield Servers(postgres.url(MIGRATED), valkey.url(0), folder, pids)


@contextmanager
def sleepers(there: Servers, net: Network, given: argparse.Namespace) -> Iterator[list[int]]:
    """A process on each host, with its share of the workers, and a reconciler; gives the ids of the former."""
    notes = there.folder / "notes"
    notes.mkdir()
    environment = there.environment(BENCHMARK_SHARD_S=str(given.shard_s), BENCHMARK_NOTES=str(notes))
    hosts: list[subprocess.Popen[bytes]] = []
    for number, host in enumerate(net.hosts):
        command = [*host, sys.executable, "-m", "benchmarks.sleeping", str(given.workers // len(net.hosts))]
        log = (there.folder / f"host{number}.log").open("wb")
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log, env=environment, cwd=ROOT)
        hosts.append(process)
    reconciler = [sys.executable, "-m", "worker.reconcile"]
    reconciler_log = there.folder / "reconciler.log"
    child = start("reconciler", reconciler, log=reconciler_log, environment=environment, folder=ROOT)
    try:
        yield [process.pid for process in hosts]
    finally:
        for process in hosts:
            process.kill()
            process.wait()
        child.stop()
        for number in range(len(net.hosts)):
            if words := (there.folder / f"host{number}.log").read_text().strip():
                print(f"  host {number} said: {words.splitlines()[-1][:200]}")


def measure(there: Servers, net: Network, given: argparse.Namespace) -> None:
    engine = create_engine(with_driver(there.database_url))
    began_s = time.perf_counter()
    with Session(engine) as session, session.begin():
        fill(session, n_runs=given.runs, n_frames=given.frames)
    with engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("ANALYZE"))
        n_shards = _one(connection, "SELECT count(*) FROM shard")
        made_s = time.perf_counter() - began_s
        print(f"{given.runs} runs of {given.frames} frames: {n_shards:,} shards, made in {made_s:.0f} s")
        queue, began_s = Queue(there.redis_url), time.perf_counter()
        n_sent = min(n_shards, MESSAGES)
        for _ in range(n_sent):
            queue.wake("detect")
        print(f"  {n_sent:,} messages sent, {n_sent / (time.perf_counter() - began_s):.0f}/s", flush=True)
        with sleepers(there, net, given) as hosts:
            _await_all_at_work(connection, given.workers)
            began = _state(connection, there.pids, hosts)
            time.sleep(given.seconds)
            ended = _state(connection, there.pids, hosts)
        report(connection, given, began, ended, there.folder / "notes")
        queue.close()
    engine.dispose()


@dataclass(frozen=True)
class State:
    """What stands in the database at a time."""

    time_s: float
    n_completed: int
    n_running: int
    n_commits: int
    cpu_s: tuple[float, ...]
    """Spent by Postgres, by Valkey, by all workers, and by whatever runs on this machine."""


def _state(connection: Connection, servers: Sequence[int], hosts: Sequence[int]) -> State:
    count = "SELECT count(*) FROM shard WHERE state = "
    commits = "SELECT xact_commit FROM pg_stat_database WHERE datname = current_database()"
    return State(
        time.time(),
        _one(connection, f"{count}'completed'"),
        _one(connection, f"{count}'running'"),
        _one(connection, commits),
        (*map(spent_s, servers), sum(map(spent_s, hosts)), machine_s()),
    )


def _await_all_at_work(connection: Connection, n_workers: int) -> None:
    deadline = time.monotonic() + _START_S
    running = "SELECT count(*) FROM shard WHERE state = 'running'"
    while (n := _one(connection, running)) < 0.95 * n_workers:
        if time.monotonic() > deadline:
            raise SystemExit(f"After {_START_S:.0f} s only {n} of {n_workers} workers are at work.")
        time.sleep(0.5)


def report(connection: Connection, given: argparse.Namespace, began: State, ended: State, notes: Path) -> None:
    seconds = ended.time_s - began.time_s
    lines = [
        [float(word) for word in line.split()] for file in notes.iterdir() for line in file.read_text().splitlines()
    ]
    lines = [line for line in lines if began.time_s <= line[0] <= ended.time_s]
    n_done = ended.n_completed - began.n_completed
    possible = given.workers / given.shard_s
    print(f"{given.workers} workers, {given.hosts or 'no'} hosts, shards of {given.shard_s:g} s, {seconds:.0f} s:")
    print(f"  {n_done / seconds:.1f} shards/s of {possible:.1f} possible; {ended.n_running} at work at the end")
    n_commits = ended.n_commits - began.n_commits
    print(f"  {len(lines) / seconds:.1f} claims/s, {n_commits / seconds:.0f} transactions/s in Postgres")
    spent = [after_s - before_s for before_s, after_s in zip(began.cpu_s, ended.cpu_s, strict=True)]
    names = ("Postgres", "Valkey", "all workers", "the whole machine")
    cores = (f"{name} {cpu_s / seconds:.2f}" for name, cpu_s in zip(names, spent, strict=True))
    print(f"  cores: {', '.join(cores)} of {os.cpu_count()}; Postgres {1000 * spent[0] / n_done:.0f} ms a shard")
    # What was claimed before was claimed while all workers connected at once.
    claims = [line[1] for line in lines if line[3] >= began.time_s]
    print(f"  to claim: {_percentiles(claims)} (of {len(claims)})")
    print(f"  to publish: {_percentiles([line[2] for line in lines])}")
    for whose in ("person", "run"):
        print(f"  {_shares(connection, whose)}")
    expired = _one(connection, "SELECT coalesce(sum(count), 0) FROM tally WHERE name = 'lease_expiries'")
    again = _one(connection, "SELECT count(*) FROM shard WHERE attempts > 1 AND state <> 'queued'")
    print(f"  leases that expired: {expired}; shards done more than once: {again}")
    for name in TABLES:
        size, n_rows = connection.execute(text(_SIZE), {"name": name}).one()
        print(f"  table {name:14} {size / 1e6:8.1f} MB, {n_rows:,} rows")


def _shares(connection: Connection, whose: str) -> str:
    """How evenly shards were done; the runs of a person are done one after the other, the oldest first."""
    done = f"""SELECT count(*) FILTER (WHERE state IN ('running', 'completed')) AS n FROM shard
               GROUP BY {whose}_id ORDER BY n"""  # noqa: S608 - our own words
    counts = connection.execute(text(done)).scalars().all()
    begun = [n for n in counts if n]
    return f"shards begun a {whose}: {min(begun)} to {max(begun)}, of {len(begun)} of {len(counts)}"


def _percentiles(values: Sequence[float]) -> str:
    if not values:
        return "none: measure for longer (--seconds)"
    ordered = sorted(values)
    at = [1000 * ordered[min(int(share * len(ordered)), len(ordered) - 1)] for share in (0.5, 0.95, 0.99)]
    return f"median {at[0]:.1f} ms, p95 {at[1]:.1f} ms, p99 {at[2]:.1f} ms, longest {1000 * ordered[-1]:.0f} ms"


def _one(connection: Connection, query: str) -> int:
    return int(connection.execute(text(query)).scalar_one())


def main() -> None:
    """Fill, work, report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=200)
    parser.add_argument("--hosts", type=int, default=0)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--seconds", type=float, default=100.0)
    parser.add_argument("--shard-s", type=float, default=20.0)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch, network(given.hosts) as net:
        folder = Path(scratch)
        folder.chmod(0o755)
        with servers(net, folder, given.workers) as there:
            measure(there, net, given)


if __name__ == "__main__":
    main()
