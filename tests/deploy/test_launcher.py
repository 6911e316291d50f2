"""`python -m deploy.local` as a person meets it: one line when ready, one line when it cannot, nothing left behind."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest

from deploy.local.instance import PAGE
from deploy.local.processes import free_port, started_at
from tests.services import ROOT, scratch_folder

DOCUMENT = {
    "name": "kept over a restart",
    "pixel_size_um": 0.625,
    "frame_interval_s": 1.0,
    "droplets": "bright",
    "material": {"delta_density_kg_m3": -30.0, "viscosity_pa_s": 0.001},
}

pytestmark = pytest.mark.skipif(not PAGE.exists(), reason="the page is not built: `make setup` builds it")


class Launcher:
    """One launcher, started as `make run` starts it, without the demo."""

    def __init__(self, data: Path, port: int) -> None:
        self.data = data
        self.api = f"http://127.0.0.1:{port}/api/v1/"
        variables = {**os.environ, "PORT": str(port), "DATA": str(data), "DEMO": "0"}
        for server in ("DATABASE_URL", "REDIS_URL", "OBJECT_STORE_URL"):
            variables.pop(server, None)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "deploy.local"],
            cwd=ROOT,
            env=variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def ready_line(self) -> str:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, self.process.communicate()[1]
        return line

    def token(self) -> dict[str, str]:
        """What a program of this machine sends."""
        return {"Authorization": f"Bearer {(self.data / 'token').read_text().strip()}"}

    def pids(self) -> dict[str, int]:
        files = (self.data / "running").glob("*.pid")
        return {file.stem: int(file.read_text().split()[0]) for file in files}

    def cpu_s(self) -> float:
        """Processor time of the launcher, what it waited for, and what runs."""
        fields = [
            Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            for pid in (self.process.pid, *self.pids().values())
        ]
        return sum(int(ticks) for process in fields for ticks in process[11:15]) / os.sysconf("SC_CLK_TCK")

    def end(self, number: signal.Signals) -> tuple[int, str, str]:
        self.process.send_signal(number)
        said, complained = self.process.communicate(timeout=60)
        return self.process.returncode, said, complained


@pytest.fixture
def launch() -> Iterator[Callable[..., Launcher]]:
    launched: list[Launcher] = []
    with scratch_folder() as folder:

        def start(*, data: str = "data", port: int | None = None) -> Launcher:
            launched.append(Launcher(folder / data, port or free_port()))
            return launched[-1]

        yield start
        for launcher in launched:
            if launcher.process.poll() is None:
                launcher.end(signal.SIGTERM)


def is_gone(pids: dict[str, int], within_s: float) -> bool:
    deadline = time.monotonic() + within_s
    while any(started_at(pid) for pid in pids.values()) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not any(started_at(pid) for pid in pids.values())


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processor time is read from /proc")
@pytest.mark.parametrize(("argument", "code"), [("--help", 0), ("--port=9", 2)])
def test_arguments_start_nothing(argument: str, code: int, tmp_path: Path) -> None:
    """Help says what the environment says; anything else is refused."""
    told = subprocess.run(
        [sys.executable, "-m", "deploy.local", argument],
        env={**os.environ, "DATA": str(tmp_path / "data"), "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert told.returncode == code
    assert ("DATA" in told.stdout) if code == 0 else (argument in told.stderr)
    assert not (tmp_path / "data").exists()


def test_data_is_kept_over_a_stop_and_the_second_start_is_quick(launch: Callable[..., Launcher]) -> None:
    port = free_port()
    first = launch(port=port)
    assert re.fullmatch(rf"Dropflow is ready: http://127\.0\.0\.1:{port}/sign-in#\S+\n", first.ready_line())
    sent = {"json": {"experiment": DOCUMENT}, "headers": first.token()}
    made = httpx.post(first.api + "experiments", **sent).raise_for_status().json()
    page = httpx.get(f"http://127.0.0.1:{port}/")
    assert page.headers["content-type"].startswith("text/html")
    pids = first.pids()
    assert first.end(signal.SIGINT) == (0, "", "")
    assert is_gone(pids, within_s=1)
    assert first.pids() == {}

    second = launch(port=port)
    second.ready_line()
    assert 0 < second.cpu_s() < 15  # on an idle machine the wait is less than this; on a busy one it says nothing
    kept = httpx.get(f"{second.api}experiments/{made['id']}", headers=second.token()).raise_for_status().json()
    assert kept["experiment"]["name"] == DOCUMENT["name"]
    assert second.end(signal.SIGTERM) == (0, "", "")


def test_a_second_instance_and_a_taken_port_are_refused_in_one_line(launch: Callable[..., Launcher]) -> None:
    port = free_port()
    first = launch(port=port)
    first.ready_line()
    same_data = launch(port=free_port())
    said, complained = same_data.process.communicate(timeout=30)
    assert (same_data.process.returncode, said, complained.count("\n")) == (2, "", 1)
    assert f"already runs on {first.data} at http://127.0.0.1:{port}/" in complained
    same_port = launch(data="other", port=port)
    said, complained = same_port.process.communicate(timeout=30)
    assert (same_port.process.returncode, said, complained.count("\n")) == (2, "", 1)
    assert f"port {port} is taken" in complained


def test_a_killed_worker_is_started_again_and_a_killed_launcher_leaves_nothing(launch: Callable[..., Launcher]) -> None:
    launcher = launch()
    launcher.ready_line()
    before = launcher.pids()
    name = next(name for name in before if name.startswith("worker"))
    os.kill(before[name], signal.SIGKILL)
    assert launcher.process.stderr is not None
    assert "was killed by signal 9; it is started again in 1 s" in launcher.process.stderr.readline()
    deadline = time.monotonic() + 10
    while launcher.pids().get(name) in (None, before[name]) and time.monotonic() < deadline:
        time.sleep(0.05)
    after = launcher.pids()
    assert after[name] != before[name]

    launcher.process.kill()
    launcher.process.communicate()
    assert is_gone(after, within_s=20)
    again = launch()
    assert again.ready_line().startswith("Dropflow is ready")


def test_the_link_lets_one_browser_in_once_and_nobody_else(launch: Callable[..., Launcher]) -> None:
    launcher = launch()
    link = launcher.ready_line().split()[-1]
    origin, _, secret = link.partition("/sign-in#")
    headers = {"Origin": origin}
    assert (launcher.data / "token").stat().st_mode & 0o777 == 0o600
    with httpx.Client(base_url=launcher.api, headers=headers) as browser:
        assert browser.get("experiments").status_code == 401
        assert browser.post("session", json={"link": "guessed"}).status_code == 401
        assert browser.post("session", json={"link": secret}).status_code == 201
        assert browser.get("experiments").status_code == 200
    with httpx.Client(base_url=launcher.api, headers=headers) as other:
        spent = other.post("session", json={"link": secret})
        assert (spent.status_code, spent.json()["code"]) == (401, "session.link_spent")
        variables = {**os.environ, "PORT": launcher.api.rpartition(":")[2].split("/")[0], "DATA": str(launcher.data)}
        asked = [sys.executable, "-m", "deploy.local.sign_in"]
        said = subprocess.run(asked, cwd=ROOT, env=variables, capture_output=True, text=True, check=True)
        assert other.post("session", json={"link": said.stdout.strip().partition("#")[2]}).status_code == 201
