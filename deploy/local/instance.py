"""One running instance: servers, migrations, processes, demo; from the first start to the last stop."""

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from typing import Self

from deploy.local.answers import status_of
from deploy.local.errors import LauncherError
from deploy.local.folder import InstanceFolder
from deploy.local.options import Options, sign_in_link
from deploy.local.postgres import Postgres, given_database, new_password
from deploy.local.processes import Child, is_port_free
from deploy.local.services import CHECKOUT, api, demo, environment_of, workers
from deploy.local.signals import StopRequested
from deploy.local.supervisor import POLL_S, Supervisor
from deploy.local.valkey import Valkey, given_queue

DATABASE = "dropflow"
PAGE = CHECKOUT / "frontend" / "dist" / "index.html"
READY_TIMEOUT_S = 90.0
SERVERS, PROGRAMS = 0, 1


class Instance:
    """Start it, watch it; leaving the context stops all of it, whatever happened."""

    def __init__(self, options: Options, folder: InstanceFolder, say: Callable[[str], None]) -> None:
        self._options, self._folder, self._say = options, folder, say
        self._supervisor = Supervisor(say)
        self._demo: Child | None = None
        self._sign_in_token = new_password()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        try:
            if self._demo is not None:
                self._demo.stop()
            self._supervisor.stop()
        except StopRequested:
            self._supervisor.kill()

    def start(self) -> None:
        """Start everything and wait until the page works."""
        if not PAGE.exists():
            raise LauncherError("the page is not built. `make run` builds it and starts everything.", exit_code=2)
        if not is_port_free(self._options.port):
            raise LauncherError(
                f"port {self._options.port} is taken by another program. Choose another: PORT=8001 make run",
                exit_code=2,
            )
        shutil.rmtree(self._folder.work)  # nobody works here yet: what is in it was left by a kill
        self._folder.work.mkdir()
        given = self._options
        database_url = given_database(given.database_url) if given.database_url else self._start_postgres()
        redis_url = given_queue(given.redis_url) if given.redis_url else self._start_valkey()
        environment = environment_of(self._options, self._folder, database_url=database_url, redis_url=redis_url)
        environment |= {
            "LOCAL_TOKEN": self._folder.program_token(),
            "SIGN_IN_TOKEN": self._sign_in_token,
            "SECRET": self._folder.password("signing"),
        }
        self._migrate(environment)
        # The page first: it is what people wait for, and the cores are few.
        self._await_page(self._supervisor.start(api(self._folder, environment), tier=PROGRAMS))
        for worker in workers(self._folder, environment):
            self._supervisor.start(worker, tier=PROGRAMS)
        if self._options.has_demo and not self._folder.demo_made.exists():
            self._demo = demo(self._options, self._folder, environment).start()

    @property
    def link(self) -> str:
        """Whoever opens it first is let in: other people of this machine reach its loopback, too."""
        return sign_in_link(self._options, self._sign_in_token)

    def watch(self) -> None:
        """Start again what dies, until a signal asks to stop."""
        while True:
            self._supervisor.check()
            if self._demo is not None and not self._demo.is_running:
                self._end_demo(self._demo)
            time.sleep(POLL_S)

    def _start_postgres(self) -> str:
        server = Postgres(
            self._folder.root / "postgres",
            password=self._folder.password("postgres"),
            log=self._folder.log(Postgres.name),
            pid_file=self._folder.pid_file(Postgres.name),
        )
        self._supervisor.start(server, tier=SERVERS)
        server.create_database(DATABASE)
        return server.url(DATABASE)

    def _start_valkey(self) -> str:
        server = Valkey(
            self._folder.root / "valkey",
            password=self._folder.password("valkey"),
            log=self._folder.log(Valkey.name),
            pid_file=self._folder.pid_file(Valkey.name),
        )
        self._supervisor.start(server, tier=SERVERS)
        return server.url()

    def _migrate(self, environment: Mapping[str, str]) -> None:
        done = subprocess.run(
            [sys.executable, "-m", "alembic", "upgrade", "head"],
            cwd=CHECKOUT,
            env=dict(environment),
            capture_output=True,
            text=True,
            check=False,
        )
        self._folder.log("migrations").write_text(done.stdout + done.stderr)
        if done.returncode != 0:
            raise LauncherError(
                f"the database could not be brought to this version of Dropflow; "
                f"{self._folder.log('migrations')} ends with: {_last_line(done.stderr)}"
            )

    def _await_page(self, api: Child) -> None:
        deadline = time.monotonic() + READY_TIMEOUT_S
        while time.monotonic() < deadline:
            if not api.is_running:
                raise LauncherError(f"the service did not start; its log {api.log} ends with:\n{api.last_words()}")
            if all(status_of(self._options.port, path) == 200 for path in ("/api/v1/health", "/")):
                return
            time.sleep(0.1)
        raise LauncherError(f"the page did not work within {READY_TIMEOUT_S:.0f} s; see {self._folder.logs}.")

    def _end_demo(self, child: Child) -> None:
        if child.process.returncode == 0:
            self._folder.demo_made.touch()
        else:
            self._say(f"the demo experiment could not be made: {_last_line(child.last_words())} (log: {child.log})")
        child.stop()
        self._demo = None


def _last_line(text: str) -> str:
    return next((line for line in reversed(text.splitlines()) if line.strip()), "nothing was said")
