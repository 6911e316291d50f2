"""`python -m benchmarks.dashboard.frames [FILM]`: step through frames of 5 megapixels in Chromium, raw and prepared.

FILM is a folder of `dropflow simulate` (default: twelve frames of the scenario dense are simulated, which takes two
minutes); it is submitted to a real service and analysed. Printed are the milliseconds from a press on "Next frame" to
the last change of the canvas, everything drawn over the frame included: of frames that were fetched ahead, as they are
for somebody who looks at each for a second, and of one that nobody could foresee.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
from playwright.sync_api import Page

from benchmarks.dashboard.browser import Act, answer, browser, opened, pressed
from tests.services import MIGRATED, database, migrate, running_postgres, running_service, running_valkey

NEXT_IN_MS = 100.0
N_STEPS, LOOKED_AT_S = 6, 1.5


def main(film: Path | None) -> int:
    """Run it; 1 where a frame that was fetched ahead comes later than it should."""
    with running_postgres() as postgres, running_valkey() as valkey, tempfile.TemporaryDirectory() as folder:
        postgres.create_database(MIGRATED)
        migrate(postgres.url(MIGRATED))
        if film is None:
            film = Path(folder) / "film"
            _dropflow("simulate", film, "--scenario", "dense", "--frames", "12", "--seed", "2")
        with (
            database(postgres, template=MIGRATED) as url,
            running_service(url, valkey.url(0)) as service,
        ):
            return measure(service.url, analysed(service.url, film))


def analysed(address: str, film: Path) -> str:
    """Submit a film, and wait for its run; the id of the run."""
    frames, described = film / "frames", film / "experiment.yaml"
    _dropflow("submit", frames, "--experiment", described, "--server", address, "--wait")
    run = httpx.get(f"{address}api/v1/runs").raise_for_status().json()["items"][0]
    return str(run["id"])


def measure(address: str, run: str) -> int:
    """Step through it, raw and prepared."""
    print(
        f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores (times hold where it is idle)"
    )
    is_slow = False
    with browser() as window:
        for name, more in (("raw", ""), ("as detection sees it", "&prepared=true")):
            page, _ = opened(window, f"{address}runs/{run}?tab=frames{more}")
            times_ms = list(_steps(page, pressed("Next frame")))
            is_slow |= max(times_ms) > NEXT_IN_MS
            print(f"{name:<22}next frame: {', '.join(f'{ms:.0f}' for ms in times_ms)} ms (at most {NEXT_IN_MS:g})")
            print(f"{'':<22}last frame: {answer(page, lambda page: page.keyboard.press('End')).whole_ms:.0f} ms")
            page.close()
    return int(is_slow)


def _steps(page: Page, act: Act) -> Iterator[float]:
    for _ in range(N_STEPS):
        time.sleep(LOOKED_AT_S)
        yield answer(page, act).whole_ms


def _dropflow(*arguments: str | Path) -> None:
    command = Path(sys.executable).with_name("dropflow")
    subprocess.run([command, *arguments], check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else None))
