"""`python -m benchmarks.load [SECONDS]`: 20 people look at dashboards while two uploads and a run go.

Everything is real and on this machine: API, workers, Postgres, Valkey. Each person asks for what a dashboard asks for,
one thing after another, and looks at it for a second (people look longer). They look at five runs: at each of these one
of them draws the figures of another stretch of time whenever they ask, the others see what was drawn before. They keep
nothing, as a browser would: every answer is sent whole. Printed: times of reads in ms, and answers that were none.
"""

import sys
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from random import random

import httpx
import numpy as np

from tests.films import EXPERIMENT, N_FRAMES, PARAMETERS, film, frame, tiff
from tests.services import MIGRATED, database, migrate, running_postgres, running_service, running_valkey

N_PEOPLE = 20
N_RUNS = 5
LOOK_S = 1.0
LONGEST_S = 120.0
UPLOADED_SHAPE = (1024, 1024)


@dataclass
class Log:
    """Seconds by what was read, and answers other than 200."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    wrong: Counter[str] = field(default_factory=Counter)

    def read(self, api: httpx.Client, name: str, path: str) -> None:
        """Ask once and write down how long it took."""
        began_s = time.perf_counter()
        try:
            answer = api.get(path)
        except httpx.HTTPError as problem:
            self.wrong[f"{name}: {type(problem).__name__}"] += 1
            return
        self.seconds[name].append(time.perf_counter() - began_s)
        if answer.status_code != httpx.codes.OK:
            self.wrong[f"{name}: {answer.status_code}"] += 1


def main(seconds: float) -> int:
    """Run it; 1 where something was answered wrongly or reads were too slow."""
    with running_postgres() as postgres, running_valkey() as valkey:
        postgres.create_database(MIGRATED)
        migrate(postgres.url(MIGRATED))
        with (
            database(postgres, template=MIGRATED) as url,
            running_service(url, valkey.url(0)) as service,
        ):
            log = measure(f"{service.url}api/v1/", seconds)
    return report(log, seconds)


def measure(address: str, seconds: float) -> Log:
    """Everybody at once, for so long."""
    log, end = Log(), threading.Event()
    with httpx.Client(base_url=address, timeout=30) as api:
        runs = [finished_run(api) for _ in range(N_RUNS)]
        people = [(runs[number % N_RUNS], number < N_RUNS) for number in range(N_PEOPLE)]
        jobs: list[Callable[[], None]] = [partial(look, address, log, *person, end) for person in people]
        jobs += [lambda: upload(address, end)] * 2 + [lambda: analyse(address, end)]
        threads = [threading.Thread(target=job) for job in jobs]
        for thread in threads:
            thread.start()
            time.sleep(LOOK_S / N_PEOPLE)  # people do not come at the same moment
        end.wait(min(seconds, LONGEST_S))
        end.set()
        for thread in threads:
            thread.join()
    return log


def dashboard(experiment: str, run: str, *, is_dragging: bool) -> Iterator[tuple[str, str]]:
    """What one dashboard asks for, again and again; who drags the range of time has figures drawn anew."""
    for number in count():
        frame = number % N_FRAMES
        stretch, what = (f"?to_s={3 + random():.6f}", ", drawn anew") if is_dragging else ("", "")
        yield "list of experiments", "experiments"
        yield "experiment", f"experiments/{experiment}"
        yield "run", f"runs/{run}"
        yield f"size distribution{what}", f"runs/{run}/figures/size_distribution_after{stretch}"
        yield f"moments{what}", f"runs/{run}/figures/moments{stretch}"
        yield "frame", f"experiments/{experiment}/frames/{frame}.jpg"
        yield "droplets", f"runs/{run}/frames/{frame}/droplets?which=tracked"


def look(address: str, log: Log, looked_at: tuple[str, str], is_dragging: bool, end: threading.Event) -> None:
    """One person at a dashboard."""
    with httpx.Client(base_url=address, timeout=30) as api:
        for name, path in dashboard(*looked_at, is_dragging=is_dragging):
            if end.wait(LOOK_S):
                return
            log.read(api, name, path)


def upload(address: str, end: threading.Event) -> None:
    """Frame after frame of a megapixel."""
    content = tiff(frame(0, UPLOADED_SHAPE))
    with httpx.Client(base_url=address, timeout=60) as api:
        made = created(api)
        for number in range(100_000):
            if end.is_set():
                return
            api.put(f"experiments/{made}/files", params={"name": f"{number}.tif"}, content=content).raise_for_status()


def analyse(address: str, end: threading.Event) -> None:
    """Run after run of a film of its own."""
    with httpx.Client(base_url=address, timeout=60) as api:
        experiment = ready(api, 40)
        for number in range(1000):
            radius_max_px = PARAMETERS["detection"]["radius_max_um"] + number  # so that nothing is used again
            detection = {**PARAMETERS["detection"], "radius_max_um": radius_max_px}
            run = started(api, experiment, {**PARAMETERS, "detection": detection})
            while api.get(f"runs/{run}").json()["state"] in ("queued", "running"):
                if end.wait(0.5):
                    return


def finished_run(api: httpx.Client) -> tuple[str, str]:
    """An experiment with a run that has everything to show."""
    experiment = ready(api, N_FRAMES)
    run = started(api, experiment, PARAMETERS)
    await_(lambda: api.get(f"runs/{run}").json()["state"] == "completed")
    return experiment, run


def created(api: httpx.Client) -> str:
    return str(api.post("experiments", json={"experiment": EXPERIMENT}).raise_for_status().json()["id"])


def ready(api: httpx.Client, n_frames: int) -> str:
    """An experiment whose frames are indexed."""
    experiment = created(api)
    for file in film(n_frames):
        api.put(f"experiments/{experiment}/files", params={"name": file.name}, content=file.content).raise_for_status()
    api.post(f"experiments/{experiment}/stack").raise_for_status()
    await_(lambda: api.get(f"experiments/{experiment}").json()["stack"]["state"] == "ready")
    return experiment


def started(api: httpx.Client, experiment: str, parameters: object) -> str:
    answer = api.post(f"experiments/{experiment}/runs", json={"parameters": parameters})
    return str(answer.raise_for_status().json()["id"])


def await_(is_so: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + LONGEST_S
    while not is_so():
        if time.monotonic() > deadline_s:
            raise TimeoutError("the service did not get ready")
        time.sleep(0.2)


def report(log: Log, seconds: float) -> int:
    """Print it."""
    every = [found for of_one in log.seconds.values() for found in of_one]
    print(f"{N_PEOPLE} people, two uploads and a run, {seconds:.0f} s: {len(every)} reads\n")
    print(f"{'read':30} {'n':>6} {'p50 ms':>8} {'p95 ms':>8} {'max ms':>8}")
    for name, of_one in [*log.seconds.items(), ("all", every)]:
        p50, p95, longest = np.percentile(of_one, [50, 95, 100]) * 1000
        print(f"{name:30} {len(of_one):6d} {p50:8.0f} {p95:8.0f} {longest:8.0f}")
    print(f"\nerrors: {sum(log.wrong.values())} {dict(log.wrong) or ''}")
    return int(bool(log.wrong) or float(np.percentile(every, 95)) > 0.3)


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 20.0))
