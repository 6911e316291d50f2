"""The processes of Dropflow itself: what they are called, and how each is started on one machine."""

import os
import signal
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
    pid_file: Path | None = None
    stop_signal: signal.Signals = signal.SIGTERM

    def start(self) -> Child:
        """Start it from the checkout; it is not waited for."""
        return start(
            self.name,
            [sys.executable, *self.command],
            log=self.log,
            environment=self.environment,
            stop_signal=self.stop_signal,
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


def workers(_folder: InstanceFolder, _environment: Mapping[str, str]) -> list[Program]:
    """None before there are any."""
    return []


def _program(
    name: str,
    command: tuple[str, ...],
    folder: InstanceFolder,
    environment: Mapping[str, str],
    stop_signal: signal.Signals = signal.SIGTERM,
) -> Program:
    return Program(name, command, environment, folder.log(name), folder.pid_file(name), stop_signal)
