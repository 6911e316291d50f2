"""What dies is started again, later each time; what ends, ends in order."""

import signal
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from deploy.local.errors import LauncherError
from deploy.local.processes import Child, start
from deploy.local.supervisor import FIRST_DELAY_S, LONGEST_DELAY_S, Supervisor, delay_s


@dataclass
class Script:
    """A service that runs a line of Python."""

    name: str
    line: str
    log: Path
    n_starts: int = 0
    refuses: list[int] = field(default_factory=list)

    def start(self) -> Child:
        self.n_starts += 1
        if self.n_starts in self.refuses:
            raise LauncherError("no room")
        return start(self.name, [sys.executable, "-c", self.line], log=self.log)


def watch(supervisor: Supervisor, until_s: float, script: Script, n_starts: int) -> None:
    deadline = time.monotonic() + until_s
    while script.n_starts < n_starts and time.monotonic() < deadline:
        supervisor.check()
        time.sleep(0.02)


def test_a_killed_process_is_started_again_and_the_person_told(tmp_path: Path) -> None:
    said: list[str] = []
    script = Script("worker", "import time; time.sleep(60)", tmp_path / "log")
    supervisor = Supervisor(said.append)
    child = supervisor.start(script, tier=0)
    child.process.send_signal(signal.SIGKILL)
    child.process.wait()
    watch(supervisor, 5, script, n_starts=2)
    assert supervisor.supervised[0].child.is_running
    assert said == [f"worker was killed by signal 9; it is started again in 1 s (log: {tmp_path / 'log'})."]
    supervisor.stop()
    assert supervisor.supervised == []


def test_a_service_that_cannot_be_started_again_is_tried_later(tmp_path: Path) -> None:
    said: list[str] = []
    script = Script("server", "raise SystemExit(3)", tmp_path / "log", refuses=[2])
    supervisor = Supervisor(said.append)
    supervisor.start(script, tier=0).process.wait()
    watch(supervisor, 8, script, n_starts=3)
    supervisor.stop()
    assert [line.split(" (log")[0] for line in said] == [
        "server ended with exit code 3; it is started again in 1 s",
        "server could not be started: no room; it is started again in 2 s",
    ]


def test_higher_tiers_end_before_those_they_use(tmp_path: Path) -> None:
    line = (
        "import signal, sys, time\n"
        "def end(*_): print(f'{sys.argv[0]} {time.monotonic_ns()}', flush=True); sys.exit(0)\n"
        "signal.signal(15, end); print('ready', flush=True); time.sleep(60)"
    )
    logs = {name: tmp_path / name for name in ("database", "worker", "api")}
    supervisor = Supervisor(print)
    for name, log in logs.items():
        supervisor.start(Script(name, line, log), tier=0 if name == "database" else 1)
    while not all(log.read_text() for log in logs.values()):
        time.sleep(0.02)
    supervisor.stop()
    ended = {name: int(log.read_text().split()[-1]) for name, log in logs.items()}
    assert ended["database"] > max(ended["worker"], ended["api"])


@given(st.integers(min_value=1, max_value=10_000))
def test_the_wait_grows_and_is_bounded(n_failures: int) -> None:
    assert FIRST_DELAY_S <= delay_s(n_failures) <= delay_s(n_failures + 1) <= LONGEST_DELAY_S
