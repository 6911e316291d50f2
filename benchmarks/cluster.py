"""How far database and queue carry: workers that sleep instead of computing, on real tables of a large laboratory.

    python -m benchmarks.cluster [--workers 200] [--runs 100] [--frames 20000] [--seconds 60] [--pause-s 1.0]

Each worker claims, is silent for the pause, and publishes, by the code of the real ones. A real shard takes 20 s, so
a pause of 1 s stands for 20 times as many workers. A claim is what a worker waits for before it may begin.
"""

import argparse
import multiprocessing
import random
import statistics
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass
from multiprocessing.sharedctypes import Synchronized
from multiprocessing.synchronize import Barrier
from pathlib import Path
from uuid import UUID, uuid4

from sqlalchemy import create_engine, insert, text
from sqlalchemy.orm import Session

from backend.models import Experiment, Group, Person, Run, Shard, Stack, Stage
from backend.platform.settings import Settings
from tests.films import EXPERIMENT, PARAMETERS
from tests.services import MIGRATED, database, migrate, running_postgres, running_valkey
from worker import outcomes, shards
from worker.context import Context, make_context
from worker.leases import Lease
from worker.outcomes import NewProduct
from worker.plan import Task

FRAMES_PER_SHARD = 50
PEOPLE = 10
SIZES = bytes(2000)


@dataclass
class Seen:
    """What the workers of one process saw."""

    claims_s: list[float]
    persons: Counter[str]
    runs: Counter[str]


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
            "start_frame": start,
            "stop_frame": min(start + FRAMES_PER_SHARD, n_frames),
            "input_key": uuid4().hex,
        }
        for start in range(0, n_frames, FRAMES_PER_SHARD)
    ]


def work(
    settings: Settings,
    n_threads: int,
    pause_s: float,
    until: "Synchronized[float]",
    ready: Barrier,
    results: "multiprocessing.Queue[Seen]",
) -> None:
    """The workers of one process, a thread each."""
    seen, lock = Seen([], Counter(), Counter()), threading.Lock()
    began = threading.local()
    contexts = [make_context(settings) for _ in range(n_threads)]

    def sleep(context: Context, lease: Lease) -> None:
        with lock:
            seen.claims_s.append(time.perf_counter() - began.at)
            seen.runs[str(lease.claim.run_id)] += 1
        time.sleep(random.uniform(0.5, 1.5) * pause_s)
        outcomes.publish(context, lease.claim, NewProduct(prefix=f"benchmark/{uuid4()}/", sizes=SIZES))

    shards.WORK = {Task.DETECT: sleep}  # type: ignore[misc]

    def one(context: Context) -> None:
        time.sleep(random.uniform(0, pause_s))
        while time.time() < until.value:
            began.at = time.perf_counter()
            shards.look_in(context, "shards")

    ready.wait()
    threads = [threading.Thread(target=one, args=(context,)) for context in contexts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    results.put(seen)


def measure(url: str, redis_url: str, folder: Path, given: argparse.Namespace) -> None:
    settings = Settings(
        database_url=url,
        redis_url=redis_url,
        object_store_url=(folder / "objects").as_uri(),
        work_dir=folder / "work",
        log_level="ERROR",
    )
    engine = create_engine(settings.database_url)
    began = time.perf_counter()
    with Session(engine) as session, session.begin():
        fill(session, n_runs=given.runs, n_frames=given.frames)
    with engine.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("ANALYZE"))
        n_shards = connection.execute(text("SELECT count(*) FROM shard")).scalar_one()
        made_s = time.perf_counter() - began
        print(f"{given.runs} runs of {given.frames} frames: {n_shards:,} shards, made in {made_s:.0f} s")
        spawn = multiprocessing.get_context("spawn")
        until, ready = spawn.Value("d", 0.0), spawn.Barrier(given.processes + 1)
        results: multiprocessing.Queue[Seen] = spawn.Queue()
        share = given.workers // given.processes
        arguments = (settings, share, given.pause_s, until, ready, results)
        processes = [spawn.Process(target=work, args=arguments) for _ in range(given.processes)]
        for process in processes:
            process.start()
        until.value = time.time() + 3600
        ready.wait()
        until.value = time.time() + given.seconds
        seen = [results.get() for _ in processes]
        for process in processes:
            process.join()
        report(given, [s for part in seen for s in part.claims_s], sum((part.runs for part in seen), Counter()))
        sizes = "SELECT relname, pg_total_relation_size(oid) FROM pg_class WHERE relname = ANY(:names)"
        for name, size in connection.execute(text(sizes), {"names": ["shard", "product", "frame_summary", "run"]}):
            print(f"  table {name:14} {size / 1e6:8.1f} MB")
        fair = (
            connection.execute(
                text("SELECT count(*) FROM shard WHERE state = 'completed' GROUP BY person_id ORDER BY 1")
            )
            .scalars()
            .all()
        )
        print(f"  shards done a person: {min(fair)} to {max(fair)} ({len(fair)} of {PEOPLE} people)")
    engine.dispose()


def report(given: argparse.Namespace, claims_s: list[float], runs: "Counter[str]") -> None:
    ordered = sorted(claims_s)
    at = lambda share: 1000 * ordered[min(int(share * len(ordered)), len(ordered) - 1)]  # noqa: E731
    print(
        f"  {given.workers} workers, pause {given.pause_s} s: {len(ordered) / given.seconds:.1f} claims/s "
        f"(at most {given.workers / given.pause_s:.0f} possible)"
    )
    print(
        f"  a claim: median {1000 * statistics.median(ordered):.1f} ms, p95 {at(0.95):.1f} ms, p99 {at(0.99):.1f} ms; "
        f"{len(runs)} runs were served"
    )


def main() -> None:
    """Fill, work, report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=200)
    parser.add_argument("--processes", type=int, default=4)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--pause-s", type=float, default=5.0)
    given = parser.parse_args()
    with running_postgres() as server, running_valkey() as queue, tempfile.TemporaryDirectory() as scratch:
        server.create_database(MIGRATED)
        migrate(server.url(MIGRATED))
        with database(server, template=MIGRATED) as url:
            measure(url, queue.url(0), Path(scratch), given)


if __name__ == "__main__":
    main()
