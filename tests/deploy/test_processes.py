"""A child process logs, dies with what it started, and is found again."""

import os
import signal
import socket
import sys
import time
from pathlib import Path

from deploy.local.processes import LOG_LIMIT_BYTES, end_left_over, is_port_free, start, started_at

PARENT_OF_A_STUBBORN_CHILD = (
    "import subprocess, sys, time\n"
    "deaf = 'import signal, time; signal.signal(15, signal.SIG_IGN); time.sleep(60)'\n"
    "child = subprocess.Popen([sys.executable, '-c', deaf])\n"
    "print(child.pid, flush=True); time.sleep(60)\n"
)


def test_stopping_a_process_ends_what_it_started(tmp_path: Path) -> None:
    log = tmp_path / "log"
    child = start("parent", [sys.executable, "-c", PARENT_OF_A_STUBBORN_CHILD], log=log)
    while not log.read_text().strip():
        time.sleep(0.02)
    grandchild = int(log.read_text())
    assert started_at(grandchild)
    assert child.stop()
    deadline = time.monotonic() + 5
    while started_at(grandchild) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not started_at(grandchild)


def test_a_process_that_does_not_stop_is_killed_and_said_so(tmp_path: Path) -> None:
    log = tmp_path / "log"
    deaf = "import signal, time; signal.signal(15, signal.SIG_IGN); print('ready', flush=True); time.sleep(60)"
    child = start("deaf", [sys.executable, "-c", deaf], log=log)
    while not log.read_text():
        time.sleep(0.02)
    assert not child.stop(timeout_s=0.2)
    assert child.process.returncode == -signal.SIGKILL


def test_the_end_of_the_log_tells_why_a_process_died(tmp_path: Path) -> None:
    child = start("broken", [sys.executable, "-c", "raise SystemExit('no such frame')"], log=tmp_path / "log")
    child.process.wait(10)
    assert child.last_words() == "no such frame"


def test_a_log_that_grew_too_long_is_put_aside(tmp_path: Path) -> None:
    log = tmp_path / "talker.log"
    log.write_bytes(b"x" * (LOG_LIMIT_BYTES + 1))
    start("talker", ["echo", "new"], log=log).process.wait(10)
    assert log.read_text() == "new\n"
    assert (tmp_path / "talker.log.1").stat().st_size == LOG_LIMIT_BYTES + 1


def test_a_process_left_behind_is_ended_at_the_next_start(tmp_path: Path) -> None:
    pid_file = tmp_path / "sleeper.pid"
    child = start("sleeper", ["sleep", "60"], log=tmp_path / "log", pid_file=pid_file)
    assert end_left_over([pid_file]) == [child.process.pid]
    assert child.process.wait(5) == -signal.SIGTERM
    assert not pid_file.exists()


def test_a_pid_used_again_by_another_process_is_left_alone(tmp_path: Path) -> None:
    reused, cut_short = tmp_path / "reused.pid", tmp_path / "cut-short.pid"
    reused.write_text(f"{os.getpid()} SIGKILL some other time")
    cut_short.write_text("")
    assert end_left_over([reused, cut_short]) == []


def test_a_port_is_taken_while_somebody_listens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        assert not is_port_free(port)
    assert is_port_free(port)
