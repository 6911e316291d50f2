"""The folder of one instance: what it holds, its passwords, and the lock that keeps a second instance out."""

import fcntl
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from deploy.local.errors import LauncherError
from deploy.local.options import Options
from deploy.local.postgres import new_password
from deploy.local.processes import end_left_over


class InstanceFolder:
    """Everything that an instance keeps, below DATA."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.objects, self.work = root / "objects", root / "work"
        self.logs, self.running = root / "logs", root / "running"
        self.token = root / "token"  # what programs of this machine show
        self.demo_made = root / "demo-made"  # so that a demo that was deleted stays away

    def make(self) -> None:
        for folder in (self.root, self.objects, self.work, self.logs, self.running):
            folder.mkdir(parents=True, exist_ok=True)

    def log(self, name: str) -> Path:
        return self.logs / f"{name.lower().replace(' ', '-')}.log"

    def pid_file(self, name: str) -> Path:
        return self.running / f"{name.lower().replace(' ', '-')}.pid"

    def password(self, server: str) -> str:
        """The password of an embedded server, made at the first start and readable by us alone."""
        path = self.root / "keys.json"
        keys: dict[str, str] = json.loads(path.read_text()) if path.exists() else {}
        if server not in keys:
            _write_secret(path, json.dumps({**keys, server: new_password()}, indent=1))
            return self.password(server)
        return keys[server]

    def program_token(self) -> str:
        """The token of programs of this machine, made at the first start and readable by us alone."""
        if not self.token.exists():
            _write_secret(self.token, f"df_{new_password()}\n")
        return self.token.read_text().strip()


def _write_secret(path: Path, content: str) -> None:
    """All of it or nothing, and never readable by others."""
    draft = path.with_name(path.name + ".new")
    draft.unlink(missing_ok=True)
    draft.touch(mode=0o600)
    draft.write_text(content)
    draft.replace(path)


@contextmanager
def open_folder(options: Options) -> Iterator[InstanceFolder]:
    """DATA, ours alone as long as the context lasts."""
    folder = InstanceFolder(options.data)
    try:
        folder.make()
        lock = (folder.root / "lock").open("a+")
    except OSError as problem:
        raise LauncherError(
            f"DATA={options.data} cannot be used: {problem.strerror} ({problem.filename}).", exit_code=2
        ) from None
    with lock:
        _take(lock, options)
        end_left_over(sorted(folder.running.glob("*.pid")))
        yield folder


def _take(lock: TextIO, options: Options) -> None:
    """The system takes the lock back when we die, however we die."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        lock.seek(0)
        raise LauncherError(
            f"another instance already runs on {options.data} at {lock.read().strip()}. "
            "Stop it first, or choose another folder: DATA=other make run",
            exit_code=2,
        ) from None
    lock.truncate(0)
    lock.write(options.address)
    lock.flush()
