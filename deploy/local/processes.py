"""One child process: it logs to its own file, dies when we die, and is found again if that failed."""

import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

LOG_LIMIT_BYTES = 20_000_000


@dataclass
class Child:
    """A running process, the leader of its own session, so that Ctrl-C reaches us alone and we stop it in order."""

    name: str
    process: subprocess.Popen[bytes]
    log: Path
    stop_signal: signal.Signals
    pid_file: Path | None = None
    is_asked_to_stop: bool = False

    @property
    def is_running(self) -> bool:
        return self.process.poll() is None

    def ask_to_stop(self) -> None:
        """Ask once: to many programs a second signal means "at once"."""
        if self.is_running and not self.is_asked_to_stop:
            self.process.send_signal(self.stop_signal)
        self.is_asked_to_stop = True

    def stop(self, timeout_s: float = 15.0) -> bool:
        """End it and all it started; False when it had to be killed."""
        self.ask_to_stop()
        try:
            self.process.wait(timeout_s)
            is_clean = True
        except subprocess.TimeoutExpired:
            is_clean = False
        kill_group(self.process.pid)
        self.process.wait()
        if self.pid_file is not None:
            self.pid_file.unlink(missing_ok=True)
        return is_clean

    def last_words(self, n_lines: int = 8) -> str:
        """The end of its log, for a report of its death."""
        with suppress(OSError):
            return "\n".join(self.log.read_text(errors="replace").splitlines()[-n_lines:])
        return ""


def start(
    name: str,
    command: Sequence[str | Path],
    *,
    log: Path,
    environment: Mapping[str, str] | None = None,
    stop_signal: signal.Signals = signal.SIGTERM,
    privileges: Sequence[str] = (),
    pid_file: Path | None = None,
    folder: Path | None = None,
) -> Child:
    """Start `command` in the background.

    Call it from the main thread: Linux sends the death signal when the thread that started the child ends.
    """
    _rotate(log)
    with log.open("ab") as output:
        process = subprocess.Popen(
            [*_guard(stop_signal, privileges), *map(str, command)],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=None if environment is None else dict(environment),
            start_new_session=True,
            cwd=folder,
        )
    if pid_file is not None:
        draft = pid_file.with_suffix(".new")
        draft.write_text(f"{process.pid} {stop_signal.name} {started_at(process.pid)}")
        draft.replace(pid_file)
    return Child(name, process, log, stop_signal, pid_file)


def _guard(stop_signal: signal.Signals, privileges: Sequence[str]) -> list[str]:
    """Have the kernel send `stop_signal` to the child when we die, even by SIGKILL. Only Linux can."""
    if shutil.which("setpriv") is None:
        return []
    return ["setpriv", "--pdeathsig", stop_signal.name.removeprefix("SIG"), *privileges]


def _rotate(log: Path) -> None:
    if log.exists() and log.stat().st_size > LOG_LIMIT_BYTES:
        log.replace(log.with_suffix(log.suffix + ".1"))


def started_at(pid: int) -> str:
    """When a process started, in the system's own words; empty when there is none. A pid alone may be used again."""
    stat = Path(f"/proc/{pid}/stat")
    if Path("/proc/self").exists():
        with suppress(OSError):
            state, *fields = stat.read_text().rpartition(")")[2].split()
            return "" if state == "Z" else fields[18]
        return ""
    return subprocess.run(
        ["ps", "-o", "lstart=", "-p", str(pid)], capture_output=True, text=True, check=False
    ).stdout.strip()


def end_left_over(pid_files: Iterable[Path], timeout_s: float = 15.0) -> list[int]:
    """End what an instance that was killed could not end itself; all are asked at once. Their pids."""
    left_over = []
    for pid_file in pid_files:
        words = pid_file.read_text().split(" ", 2)
        pid_file.unlink()
        if len(words) == 3 and words[2] and started_at(int(words[0])) == words[2]:
            left_over.append((int(words[0]), words[1], words[2]))
    for pid, signal_name, _ in left_over:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.Signals[signal_name])
    deadline = time.monotonic() + timeout_s
    for pid, _, start_time in left_over:
        while started_at(pid) == start_time and time.monotonic() < deadline:
            time.sleep(0.05)
        kill_group(pid)
    return [pid for pid, _, _ in left_over]


def kill_group(pid: int) -> None:
    """Kill what is left of the session that `pid` led."""
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def free_port() -> int:
    """A TCP port of the loopback interface that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def is_port_free(port: int) -> bool:
    with socket.socket() as probe:
        # As the servers do: a connection that a former server left in TIME_WAIT does not hold the port.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True
