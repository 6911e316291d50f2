"""A stack of gigabytes from somebody's disk to finished results, while every process on the way is killed once.

    python -m tests.e2e.whole_way [--way client|page] [--frames 1000] [--megabytes-a-frame 5] [--folder FOLDER]

The frames are drawn (fifteen discs that rise as Stokes has it, over noise, 32-bit, each unlike all others) and sent by
`dropflow submit`, or dropped on the page in Chromium. On the way the sender is killed or the browser closed, and so are
the API, Postgres, Valkey, the reconciler, each worker, and whoever reads, detects and tracks at that moment; each is
started again as `make run` does it. At the end every file has the checksum of the one that was sent, the run is
completed, every disc is one trajectory through all frames where it was drawn and there is no other, no shard was
counted twice and nothing is left running. Each step is printed with its time.
"""

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import yaml
from playwright.sync_api import Page, expect

from backend.models import Shard
from backend.models.states import ShardState
from tests.e2e.browser import drop, open_page
from tests.e2e.rising import PARAMETERS, Rising
from tests.faults import Deployment, deployment, run_id
from tests.house import Json

TARGET = "Drop a folder, images, a film or a ZIP here"
NAME = "the whole way"
SENDER_LOG = "submit.log"
IDLE = ("Valkey", "reconciler", "worker interactive", "worker shards", "worker ingest")
PATIENCE_S = 1500.0
_began_s = time.monotonic()


def say(text: str) -> None:
    """One line, with the time since the beginning."""
    sys.stdout.write(f"{time.monotonic() - _began_s:7.1f} s  {text}\n")
    sys.stdout.flush()


class Way:
    """What is watched and killed meanwhile."""

    def __init__(self, place: Deployment) -> None:
        self.place = place

    def until(self, what: str, condition: Callable[[], bool]) -> None:
        """Look after all processes until a condition holds."""
        self.place.look_after(condition, PATIENCE_S)
        say(what)

    def kill(self, victim: str, is_too_late: Callable[[], bool] = lambda: False) -> None:
        """Kill one as soon as it is there; a short film may be done with its work before."""
        n_before = self.place.kills[victim]
        self.place.look_after(lambda: self.place.kill(victim) or is_too_late(), PATIENCE_S)
        say(f"killed: {victim}" if self.place.kills[victim] > n_before else f"too late to kill: {victim}")

    def ask(self, path: str) -> Json | None:
        """What the API says, if it answers."""
        try:
            with self.place.client() as api:
                answer = api.get(path)
        except httpx.TransportError:
            return None
        body: Json = answer.json()
        return body if answer.status_code == 200 else None

    def experiment(self) -> Json | None:
        """The experiment, once it was made."""
        found = self.ask("experiments")
        return next((item for item in found["items"] if item["experiment"]["name"] == NAME), None) if found else None

    def run(self) -> Json | None:
        """Its run, once it was started."""
        experiment = self.experiment()
        found = self.ask(f"experiments/{experiment['id']}/runs") if experiment else None
        return found["items"][0] if found and found["items"] else None

    def sent_share(self, n_bytes: int) -> float:
        """Which part of the bytes has arrived: whole files, and what the uploads on their way have."""
        experiment = self.experiment()
        if experiment is None:
            return 0.0
        coming = self.ask(f"experiments/{experiment['id']}/uploads")
        on_their_way = sum(item["offset_bytes"] for item in coming["items"]) if coming else 0
        return float((experiment["stack"]["size_bytes"] + on_their_way) / n_bytes)

    def is_sent(self) -> bool:
        """Whether the frames are being read, or were."""
        experiment = self.experiment()
        return experiment is not None and experiment["stack"]["state"] in ("indexing", "ready")

    def is_ready(self) -> bool:
        """Whether they were."""
        experiment = self.experiment()
        return experiment is not None and experiment["stack"]["state"] == "ready"

    def is_over(self) -> bool:
        """Whether the run has ended."""
        run = self.run()
        return run is not None and run["state"] not in ("queued", "running")

    def detected_share(self) -> float:
        """In which part of the frames droplets were found."""
        run = self.run()
        if run is None:
            return 0.0
        (detect,) = (stage for stage in run["stages"] if stage["name"] == "detect")
        return float(detect["done_frames"] / detect["total_frames"])

    def disturb_run(self) -> None:
        """Kill everybody once while the run goes: one after the other while it detects, then those who track."""
        while_detecting = ("busy detect", "API", "PostgreSQL", *IDLE)
        for n_before, victim in enumerate(while_detecting):
            share = n_before / len(while_detecting)
            self.place.look_after(lambda share=share: self.detected_share() >= share or self.is_over(), PATIENCE_S)  # type: ignore[misc]
            self.kill(victim, self.is_over)
        for victim in ("busy track", "worker sequential"):
            self.kill(victim, self.is_over)


def by_client(way: Way, film: Rising, folder: Path, n_bytes: int) -> None:
    """Send with `dropflow submit`, which is killed on the way and started again."""
    description, parameters = folder.parent / "experiment.yaml", folder.parent / "parameters.yaml"
    description.write_text(yaml.safe_dump(film.describe(NAME)))
    parameters.write_text(yaml.safe_dump(PARAMETERS))
    log = folder.parent / SENDER_LOG

    def lives() -> bool:
        assert sender.poll() in (None, 0), log.read_text()
        return True

    with _submitting(way, folder, description, parameters) as sender:
        way.until("a quarter has arrived", lambda: lives() and way.sent_share(n_bytes) > 0.25)
        sender.kill()
        say("killed: dropflow submit")
    reached = max(0.5, way.sent_share(n_bytes))
    with _submitting(way, folder, description, parameters) as sender:
        way.until("half has arrived", lambda: lives() and (way.sent_share(n_bytes) > reached or way.is_sent()))
        way.kill("API")
        way.until("all has arrived", lambda: lives() and way.is_sent())
        way.kill("busy ingest", way.is_ready)
        way.until("the run has begun", lambda: lives() and way.run() is not None)
        sender.kill()
    way.disturb_run()


@contextmanager
def _submitting(way: Way, folder: Path, description: Path, parameters: Path) -> Iterator[subprocess.Popen[bytes]]:
    program = (sys.executable, "-c", "from dropflow.cli import main; main()", "submit", folder)
    about = ("--experiment", description, "--parameters", parameters, "--wait")
    server = ("--server", f"http://127.0.0.1:{way.place.port}/")
    environment = {**os.environ, "DROPFLOW_CONFIG": str(folder.parent / "servers.yaml")}
    with (folder.parent / SENDER_LOG).open("wb") as log:
        sender = subprocess.Popen([*program, *about, *server], env=environment, stderr=log)
        try:
            yield sender
        finally:
            sender.kill()
            sender.wait()


def by_page(way: Way, film: Rising, folder: Path, n_bytes: int) -> None:
    """Drop the folder on the page; the browser is closed while it sends, and again while the run goes."""
    address = f"http://127.0.0.1:{way.place.port}/"
    with way.place.client() as api:
        experiment = api.post("experiments", json={"experiment": film.describe(NAME)}).json()
        preset = {"name": NAME, "parameters": PARAMETERS}
        assert api.post(f"groups/{experiment['group']['id']}/presets", json=preset).status_code == 201
    made = experiment["id"]
    with open_page(address) as page:
        _send(page, made, folder)
        way.until("a quarter has arrived", lambda: _seen(page) and way.sent_share(n_bytes) > 0.25)
    say("closed: the browser")
    with open_page(address) as page:
        _send(page, made, folder)
        way.until("half has arrived", lambda: _seen(page) and way.sent_share(n_bytes) > 0.5)
        way.kill("API")
        way.until("all has arrived", lambda: _seen(page) and way.is_sent())
        way.kill("busy ingest", way.is_ready)
        ready = page.get_by_text("frames ready")
        way.until("the page says that frames are ready", lambda: _seen(page) and ready.is_visible())
        page.goto(f"experiments/{made}/analyse")
        page.get_by_label("Order, times and scale are right").check()
        page.get_by_role("button", name="Presets").click()
        page.get_by_role("button", name=f"Use {NAME}").click()
        page.get_by_role("button", name="Start the run").click()
        way.until("the run has begun", lambda: _seen(page) and way.run() is not None)
    say("closed: the browser")
    way.disturb_run()


def _send(page: Page, experiment: str, folder: Path) -> None:
    page.goto(f"experiments/{experiment}")
    drop(page, TARGET, folder)
    page.get_by_role("button", name="Upload").click(timeout=60_000)
    expect(page.get_by_label("Sending")).to_be_visible()


def _seen(page: Page) -> bool:
    """Let the browser go on for a moment; nobody clicks there, whatever dies."""
    page.wait_for_timeout(100)
    return True


def check(way: Way, film: Rising, folder: Path) -> None:
    """That nothing was lost, doubled or left."""
    run: Any = way.run()
    assert run["state"] == "completed", run["problem"]
    experiment: Any = way.experiment()
    with way.place.client() as api:
        sent: dict[str, str] = {}
        cursor = None
        while True:
            query = {"limit": 500} | ({"cursor": cursor} if cursor else {})
            found = api.get(f"experiments/{experiment['id']}/files", params=query).json()
            sent |= {item["name"].split("/")[-1]: item["sha256"] for item in found["items"]}
            if (cursor := found["next_cursor"]) is None:
                break
    assert sent == {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}
    say(f"all {len(sent)} files have the checksum of what was sent")
    shards = way.place.shards(Shard.run_id == run_id(run))
    assert {shard.state for shard in shards} == {ShardState.COMPLETED}
    detected = [at for shard in shards if shard.task == "detect" for at in range(shard.start_frame, shard.stop_frame)]
    assert detected == list(range(film.n_frames))
    assert way.place.open_work() == (0, 0)
    say(f"{len(shards)} shards, each counted once; nothing is left running")
    with way.place.client() as api:
        say(film.check(api.get(f"runs/{run['id']}/files/trajectories.parquet").content))
    say(f"killed: {dict(way.place.kills)}")


def main() -> None:
    """Go the whole way once."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--way", choices=("client", "page"), default="client")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--megabytes-a-frame", type=float, default=5.0)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    asked = parser.parse_args()
    tempfile.tempdir = str(asked.folder)
    with tempfile.TemporaryDirectory(prefix="dropflow-whole-way-") as scratch:
        folder = Path(scratch) / "frames"
        film = Rising.of_bytes(asked.frames, int(asked.megabytes_a_frame * 1e6))
        film.draw(folder)
        n_bytes = sum(path.stat().st_size for path in folder.iterdir())
        say(f"{asked.frames} frames, {n_bytes / 1e9:.2f} GB, by {asked.way}")
        with deployment() as place:
            way = Way(place)
            (by_page if asked.way == "page" else by_client)(way, film, folder, n_bytes)
            way.until("the run is over", way.is_over)
            check(way, film, folder)


if __name__ == "__main__":
    main()
