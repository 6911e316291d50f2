"""A folder on its way through the page: the tab is closed, the server killed, and nothing is sent twice or lost."""

import hashlib
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from deploy.local.processes import kill_group
from tests.e2e.browser import drop, open_page, serious_findings
from tests.e2e.film import TARGET
from tests.films import EXPERIMENT, tiff
from tests.services import ROOT, RunningService, running_service, scratch_folder

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

N_FILES = 150
SOME_ARRIVED = "() => /[1-9][0-9]* MB of 1[0-9]+ MB/.test(document.body.innerText)"


@pytest.fixture
def folder() -> Iterator[Path]:
    """Noise, which no way of sending can make smaller; outside pytest's own folder, which keeps the last runs."""
    with scratch_folder() as folder:
        noise = np.random.default_rng(0).integers(0, 255, (1000, 1000), np.uint8)
        for number in range(N_FILES):
            (folder / f"frame{number}.tif").write_bytes(tiff(np.roll(noise, number, axis=1)))
        yield folder


@pytest.fixture
def own_service(database_url: str, redis_url: str) -> Iterator[RunningService]:
    with running_service(database_url, redis_url) as running:
        yield running


def test_a_folder_survives_a_closed_tab_and_a_killed_server(own_service: RunningService, folder: Path) -> None:
    with httpx.Client(base_url=f"{own_service.url}api/v1/", timeout=30) as api:
        experiment = api.post("experiments", json={"experiment": EXPERIMENT}).json()["id"]
        with open_page(own_service.url) as first_tab:
            _send(first_tab, experiment, folder)
            first_tab.wait_for_function(SOME_ARRIVED, polling=20)
        missing = api.get(f"experiments/{experiment}/uploads").json()
        assert missing["n_files_missing"] > 0
        with open_page(own_service.url) as other_browser, ExitStack() as restarted:
            _send(other_browser, experiment, folder, look=True)
            restarted.enter_context(_killed_and_started_again(own_service))
            expect(other_browser.get_by_text("frames ready")).to_be_visible(timeout=120_000)
            assert serious_findings(other_browser) == []
            listed = api.get(f"experiments/{experiment}/files", params={"limit": 500}).json()["items"]
    assert {file["name"].split("/")[-1]: file["sha256"] for file in listed} == {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()
    }


N_SMALL_FILES = 20_000
MOST_SERVER_KB = 400_000
LONGEST_STALL_MS = 5_000
WATCH_STALLS = """() => { window.longestStallMs = 0; let last = performance.now(); setInterval(() => {
  const now = performance.now(); window.longestStallMs = Math.max(window.longestStallMs, now - last - 50); last = now;
}, 50); }"""


@pytest.mark.timeout(800)
def test_twenty_thousand_small_files_leave_the_page_responsive_and_the_server_small(
    own_service: RunningService,
) -> None:
    with scratch_folder() as folder, httpx.Client(base_url=f"{own_service.url}api/v1/", timeout=30) as api:
        noise = np.random.default_rng(0).integers(0, 255, (16, 24), np.uint8)
        for number in range(N_SMALL_FILES):
            (folder / f"frame{number}.tif").write_bytes(tiff(noise + np.uint8(number % 251)))
        experiment = api.post("experiments", json={"experiment": EXPERIMENT}).json()["id"]
        with open_page(own_service.url) as page:
            page.goto(f"experiments/{experiment}")
            page.evaluate(WATCH_STALLS)
            drop(page, TARGET, folder)
            page.get_by_role("button", name=re.compile("^Upload")).click(timeout=120_000)
            expect(page.get_by_label("Sending")).to_be_visible(timeout=60_000)
            page.get_by_role("button", name="Use dark colours").click(timeout=LONGEST_STALL_MS)
            expect(page.get_by_role("button", name="Use light colours")).to_be_visible()
            assert page.locator("main *").count() < 500  # never a row a file
            expect(page.get_by_text("frames ready")).to_be_visible(timeout=600_000)
            assert page.evaluate("window.longestStallMs") < LONGEST_STALL_MS
        stack = api.get(f"experiments/{experiment}").json()["stack"]
        assert (stack["n_files"], stack["n_frames"]) == (N_SMALL_FILES, N_SMALL_FILES)
        assert most_memory_kb(own_service.children["API"].process.pid) < MOST_SERVER_KB


def most_memory_kb(process: int) -> int:
    """The most that a process has had in memory so far."""
    status = Path(f"/proc/{process}/status").read_text()
    return int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))


def _send(page: Page, experiment: str, folder: Path, *, look: bool = False) -> None:
    page.goto(f"experiments/{experiment}")
    if look:
        expect(page.get_by_text(re.compile("announced files? "))).to_be_visible()
        assert serious_findings(page) == []
    drop(page, TARGET, folder)
    page.get_by_role("button", name=re.compile("^Upload")).click()
    expect(page.get_by_label("Sending")).to_be_visible()


@contextmanager
def _killed_and_started_again(service: RunningService) -> Iterator[None]:
    killed = service.children["API"].process
    kill_group(killed.pid)
    killed.wait()
    arguments = ("--host", "127.0.0.1", "--port", service.environment["PORT"], "--timeout-graceful-shutdown", "1")
    command = (sys.executable, "-m", "uvicorn", "backend.app:create_app", "--factory", *arguments)
    again = subprocess.Popen(command, env=dict(service.environment), cwd=ROOT)
    try:
        yield
    finally:
        again.terminate()
        again.wait()
