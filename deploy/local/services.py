"""The processes of Dropflow itself: what they are called, and how each is started on one machine."""

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from deploy.local.folder import InstanceFolder
from deploy.local.options import HOST, Options
from deploy.local.processes import Child, start

CHECKOUT = Path(__file__).resolve().parents[2]
# Workers share the cores by being many; threads within each would only get into each other's way.
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "POLARS_MAX_THREADS"), "1")


@dataclass(frozen=True)
class Program:
    """One long-running process of ours."""

    name: str
    command: tuple[str, ...]
    environment: Mapping[str, str]
    log: Path
    pid_file: Path

    def start(self) -> Child:
        """Start it from the checkout; it is not waited for."""
        return start(
            self.name,
            [sys.executable, *self.command],
            log=self.log,
            environment=self.environment,
            pid_file=self.pid_file,
            folder=CHECKOUT,
        )


def environment_of(
    options: Options, folder: InstanceFolder, *, database_url: str, redis_url: str, host: str = HOST
) -> dict[str, str]:
    """The settings of every process of this instance."""
    return {
        **os.environ,
        **ONE_THREAD,
        # Each thread would keep freed memory for itself: what many requests freed, once each.
        "MALLOC_ARENA_MAX": "2",
        "DATABASE_URL": database_url,
        "REDIS_URL": redis_url,
        "OBJECT_STORE_URL": os.environ.get("OBJECT_STORE_URL") or folder.objects.as_uri(),
        "WORK_DIR": str(folder.work),
        "HOST": host,
        "PORT": str(options.port),
    }


def api(folder: InstanceFolder, environment: Mapping[str, str]) -> Program:
    """The HTTP service; connections that stay open (live progress) do not hold up its end."""
    command = ("-m", "uvicorn", "backend.app:create_app", "--factory", "--no-access-log")
    address = ("--host", environment["HOST"], "--port", environment["PORT"], "--timeout-graceful-shutdown", "2")
    return _program("API", (*command, *address), folder, environment)


def demo(options: Options, folder: InstanceFolder, environment: Mapping[str, str]) -> Program:
    """The demo, sent once."""
    return _program("demo", ("-m", "deploy.local.demo", options.address), folder, environment)


def workers(folder: InstanceFolder, environment: Mapping[str, str]) -> list[Program]:
    """Shards have a process a core. What takes hours has its own; who waits at the page, two: one may be measuring."""
    n_cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    processes = {"shards": n_cores, "sequential": max(1, n_cores // 2), "ingest": 1, "interactive": 2}
    return [
        *(_worker(queue, n_processes, folder, environment) for queue, n_processes in processes.items()),
        _program("reconciler", ("-m", "worker.reconcile"), folder, environment),
    ]


def _worker(queue: str, n_processes: int, folder: InstanceFolder, environment: Mapping[str, str]) -> Program:
    command = ("-m", "celery", "--app", "worker.app", "worker", "--queues", queue, "--concurrency", str(n_processes))
    # Nobody asks these workers anything but through the queue and the database.
    quiet = ("--hostname", f"{queue}@%h", "--without-gossip", "--without-mingle", "--without-heartbeat")
    # To Celery SIGTERM means to end the work at hand first; SIGQUIT to give it back, for the next start to go on with.
    # People look while workers work: but what somebody waits for is as urgent as the page itself.
    own = {"REMAP_SIGTERM": "SIGQUIT", **({"WORKER_NICE": "0"} if queue == "interactive" else {})}
    return _program(f"worker {queue}", (*command, *quiet), folder, {**environment, **own})


def _program(
    name: str,
    command: tuple[str, ...],
    folder: InstanceFolder,
    environment: Mapping[str, str],
) -> Program:
    return Program(name, command, environment, folder.log(name), folder.pid_file(name))
