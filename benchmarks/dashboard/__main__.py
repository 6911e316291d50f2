"""`python -m benchmarks.dashboard [FRAMES] [DROPLETS]`: open a run of 20,000 frames in Chromium, and work with it.

Everything is real but the run's tables, which are made up (straight paths, no frames): Postgres, API, the built page.
Printed: seconds until the page stands there whole, in a browser that has seen nothing of it yet; and of each action the
milliseconds from the input (a key pressed, a pointer let go) to the next picture, in which the page shows that it heard
("seen"), and to the last change that followed of the document or a canvas ("whole"). What is out of sight is drawn
when somebody comes to it, and counts there.
"""

import os
import sys
import tempfile
from pathlib import Path

from benchmarks.dashboard.browser import Act, answer, browser, drawn_over, opened, pressed, tab
from benchmarks.dashboard.film import make_run
from tests.services import MIGRATED, database, migrate, running_postgres, running_service, running_valkey

OPENS_IN_S, ANSWERS_IN_MS = 2.0, 300.0
BEFORE = "Size distribution before tracking"
ACTIONS: tuple[tuple[str, Act], ...] = (
    ("zoom into a third of the film", drawn_over(BEFORE, 0.3, 0.6, 0.2, 0.9)),
    ("zoom into a third of that", drawn_over(BEFORE, 0.3, 0.6, 0.1, 0.9)),
    ("show everything", pressed("Show everything")),
    ("zoom elsewhere", drawn_over(BEFORE, 0.7, 0.9, 0.1, 0.9)),
    ("tab Flow", tab("Flow")),
    ("next step of the flow", pressed("Next frame")),
    ("another step of the flow", pressed("Next frame")),
    ("tab Over time", tab("Over time")),
    ("tab Figures", tab("Figures")),
    ("velocity against radius", pressed("Vertical velocity against radius")),
    ("tab Quality", tab("Quality")),
    ("tab Droplets", tab("Droplets")),
    ("next frame", pressed("Next frame")),
    ("tab Sizes", tab("Sizes")),
)


def main(n_frames: int, n_droplets: int) -> int:
    """Run it; 1 where something is slower than it should be."""
    with running_postgres() as postgres, running_valkey() as valkey, tempfile.TemporaryDirectory() as folder:
        postgres.create_database(MIGRATED)
        migrate(postgres.url(MIGRATED))
        with (
            database(postgres, template=MIGRATED) as url,
            running_service(url, valkey.url(0)) as service,
        ):
            run = make_run(service.environment, Path(folder), n_frames, n_droplets)
            print(f"{n_frames:,} frames, {n_droplets} droplets a frame")
            return measure(f"{service.url}runs/{run}")


def measure(address: str) -> int:
    """Open it three times, then do what people do."""
    print(
        f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores (times hold where it is idle)"
    )
    with browser() as window:
        opened(window, address)[0].close()  # what the service itself loads at its first use is not the page's
        times_s = []
        for _ in range(3):
            page, took_s = opened(window, address)
            times_s.append(took_s)
        worst_s = max(times_s)
        print(f"opens in {', '.join(f'{one:.2f}' for one in times_s)} s (at most {OPENS_IN_S:g})")
        is_slow = worst_s > OPENS_IN_S
        print(f"{'':<32}{'seen':>8}{'whole':>8} (ms)")
        for name, act in ACTIONS:
            took = answer(page, act)
            is_slow |= took.whole_ms > ANSWERS_IN_MS
            note = "   slow" if took.whole_ms > ANSWERS_IN_MS else ""
            print(f"{name:<32}{took.seen_ms:>8.0f}{took.whole_ms:>8.0f}{note}")
    return int(is_slow)


if __name__ == "__main__":
    sys.exit(main(*(int(word) for word in (*sys.argv[1:], *("20000", "500")[len(sys.argv) - 1 :]))))
