"""Frames a second that the service detects, by the number of worker processes, and the bytes that a frame leaves.

    python -m benchmarks.throughput [--workers 1 2] [--hosts] [--frames 24] [--scenario easy]

Everything is as on a lab server: frames in an S3 store, one process a worker, Postgres that waits for its disk. With
--hosts each worker runs in a network namespace of its own (needs root) and reaches the servers over a bridge. The film
has frames of 2058 x 2448 pixels and is analysed with default parameters. Time counts from the first claim of a shard of
detection to the last publishing, by the clock of the database.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from uuid import UUID

from sqlalchemy import Engine, create_engine, text

from backend.platform.object_store import ObjectStore
from backend.platform.settings import with_driver
from benchmarks.analyse import COMMAND, first_frames
from benchmarks.cluster import Servers, servers
from benchmarks.hosts import Network, network
from deploy.local.answers import status_of
from deploy.local.processes import free_port, start
from dropflow.client import Client
from dropflow.client.runs import Run
from tests.s3 import BUCKET, KEYS, running_s3
from tests.services import ROOT

_STAGES = """
SELECT task, sum(stop_frame - start_frame), extract(epoch FROM max(finished_at) - min(started_at)), count(*)
FROM shard WHERE run_id = :run AND NOT is_reused GROUP BY task
"""
_DATABASE = (
    "SELECT sum(pg_total_relation_size(oid)) FROM pg_class WHERE relname IN ('shard', 'product', 'frame_summary')"
)


_LONGEST_S = 3600.0
"""For one run: on a busy machine a frame takes many times as long."""
_LARGE = 20_000
"""Frames of an experiment of 100 GB."""


@contextmanager
def running(command: Sequence[str], name: str, there: Servers, environment: dict[str, str]) -> Iterator[None]:
    """A process of the service, meanwhile."""
    child = start(name, command, log=there.folder / f"{name}.log", environment=environment, folder=ROOT)
    try:
        yield
        if not child.is_running:
            sys.exit(f"{name} died: {child.last_words(20)}")
    finally:
        child.stop()


@contextmanager
def worker(
    queue: str, n_processes: int, there: Servers, environment: dict[str, str], host: Sequence[str] = ()
) -> Iterator[None]:
    """A worker of one queue, on a host."""
    name = f"{queue}-{host[-1]}" if host else queue
    celery = ("-m", "celery", "--app", "worker.app", "worker", "--queues", queue, "--hostname", f"{name}@%h")
    command = [*host, sys.executable, *celery, "--concurrency", str(n_processes), "--without-mingle"]
    with running(command, name, there, environment):
        yield


@contextmanager
def shard_workers(n: int, net: Network, there: Servers, environment: dict[str, str]) -> Iterator[None]:
    """One process on each of `n` hosts, or `n` processes here."""
    with ExitStack() as stack:
        if net.hosts == ((),):
            stack.enter_context(worker("shards", n, there, environment))
        else:
            for host in net.hosts[:n]:
                stack.enter_context(worker("shards", 1, there, environment, host))
        yield


@contextmanager
def service(there: Servers, environment: dict[str, str]) -> Iterator[Client]:
    """The API and all workers but those that detect."""
    port = free_port()
    api = [sys.executable, "-m", "uvicorn", "backend.app:create_app", "--factory", "--port", str(port)]
    with ExitStack() as stack:
        stack.enter_context(running(api, "api", there, environment))
        stack.enter_context(running([sys.executable, "-m", "worker.reconcile"], "reconciler", there, environment))
        for queue in ("ingest", "sequential"):
            stack.enter_context(worker(queue, 1, there, environment))
        while status_of(port, "/api/v1/health") != 200:
            time.sleep(0.1)
        yield stack.enter_context(Client(f"http://127.0.0.1:{port}/"))


def measured(engine: Engine, run: Run, n_frames: int) -> dict[str, float]:
    """Frames a second of each task."""
    with engine.connect() as connection:
        rows = connection.execute(text(_STAGES), {"run": run.id}).all()
    return {task: n_frames / float(seconds) for task, _, seconds, _ in rows}


def left(engine: Engine, environment: dict[str, str], experiment_id: UUID) -> dict[str, int]:
    """Bytes of an experiment in the object store by kind, and of the tables of shards in Postgres."""
    sizes = {"frames": 0, "results": 0}
    for key, size in ObjectStore(environment["OBJECT_STORE_URL"]).list(f"experiments/{experiment_id}/"):
        sizes["frames" if "/files/" in key else "results"] += size
    with engine.connect() as connection:
        return sizes | {"database": int(connection.execute(text(_DATABASE)).scalar_one())}


def main() -> None:
    """Simulate, send, measure with each number of workers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--hosts", action="store_true")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--scenario", default="easy")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch, network(max(given.workers) if given.hosts else 0) as net:
        folder = Path(scratch)
        folder.chmod(0o755)
        film = folder / "film"
        options = ["--scenario", given.scenario, "--frames", str(given.frames), "--seed", "77"]
        subprocess.run([*COMMAND, "simulate", film, *options], check=True, stdout=subprocess.DEVNULL)
        short = first_frames(film, 4, folder / "short")
        with servers(net, folder, 10) as there, running_s3(net.address) as port:
            store = {"OBJECT_STORE_URL": f"s3://{BUCKET}", "AWS_ENDPOINT_URL": f"http://{net.address}:{port}"}
            more = {"AWS_ALLOW_HTTP": "true", "AWS_REGION": "us-east-1", "AUTH": "local", "HOST": "127.0.0.1"}
            measure(there, net, given, film, short, there.environment(**KEYS, **store, **more))


def measure(
    there: Servers, net: Network, given: argparse.Namespace, film: Path, short: Path, environment: dict[str, str]
) -> None:
    """Print a line for each number of workers, and what is left of a frame."""
    os.environ.update({name: environment[name] for name in environment if name.startswith(("AWS_", "OBJECT_"))})
    engine = create_engine(with_driver(there.database_url))
    with service(there, environment) as client:
        with shard_workers(1, net, there, environment):
            client.film(short, film / "experiment.yaml").start().wait(timeout_s=_LONGEST_S)
        first_s, sizes = 0.0, dict[str, int]()
        for n in given.workers:
            # Another experiment of the same film: a run never does again what one of its own experiment has done.
            experiment = client.film(film / "frames", film / "experiment.yaml", is_again=True)
            with shard_workers(n, net, there, environment):
                run = experiment.start().wait(timeout_s=_LONGEST_S)
            rates = measured(engine, run, given.frames)
            first_s = first_s or rates["detect"]
            print(
                f"{n} workers{', a host each' if given.hosts else ''}: detection {rates['detect']:.2f} frames/s, "
                f"{rates['detect'] / first_s:.2f} times the first; tracking {rates['track']:.2f} frames/s; "
                f"{_LARGE:,} frames: {_LARGE * (1 / rates['detect'] + 1 / rates['track']) / 3600:.1f} h",
                flush=True,
            )
            sizes = sizes or left(engine, environment, experiment.id)
        for kind, size in sizes.items():
            frame = size / given.frames
            print(f"  {kind}: {frame / 1e3:,.1f} kB a frame, {_LARGE * frame / 1e9:.1f} GB of {_LARGE:,} frames")
    engine.dispose()


if __name__ == "__main__":
    main()
