"""Every figure of a run of 20,000 frames with 500 droplets each, asked for over HTTP: milliseconds of each.

    python -m benchmarks.figures [--frames 20000] [--droplets 500] [--repeat 5]

The tables are those of `benchmarks.statistics_speed`, kept as a run leaves them; the service is the real one on its own
Postgres. Each line is the median and the largest of some requests after a first one, which loads code; what the service
keeps of figures that it drew and of what they are drawn from is thrown away before each. The aim is 300 ms.
"""

import argparse
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from uuid import UUID

import numpy as np
import pyarrow.parquet as pq

from backend.platform.kept import Kept
from backend.platform.object_store import ObjectStore
from backend.results.film import kept_arrays
from benchmarks.completed_run import keep_frames, keep_product, keep_run, noise, quality_files
from benchmarks.statistics_speed import HEIGHT_PX, WIDTH_PX, write_tables
from dropflow.droplets import Droplets
from dropflow.figures.catalogue import CATALOGUE
from dropflow.figures.example import EXAMPLE_FILE, make_example
from dropflow.preprocess import StackEstimate
from dropflow.preprocess.estimate import ESTIMATE_FILE
from dropflow.results import Results, open_results
from dropflow.statistics.condense import condense
from dropflow.statistics.condensed_files import FILES, write_condensed
from tests.house import House, house_settings, open_house
from tests.services import migrate, running_postgres, running_valkey

LIMIT_MS = 300
_FRAMES_A_SHARD = 250


def main() -> None:
    """Make the run, ask for everything, print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--droplets", type=int, default=500)
    parser.add_argument("--repeat", type=int, default=5)
    given = parser.parse_args()
    with running_postgres() as postgres, running_valkey() as valkey, tempfile.TemporaryDirectory() as folder:
        postgres.create_database("figures")
        migrate(postgres.url("figures"))
        results = make_results(Path(folder) / "results", given.frames, given.droplets)
        with open_house(house_settings(postgres.url("figures"), valkey.url(0), Path(folder))) as house:
            run_id = keep(house, results)
            slow = measure(house, run_id, given.frames, given.repeat)
    print(f"slower than {LIMIT_MS} ms: {', '.join(slow) or 'none'}")


def make_results(folder: Path, n_frames: int, n_droplets: int) -> Results:
    """A folder as an analysis leaves it."""
    folder.mkdir()
    write_tables(folder, n_frames, n_droplets)
    results = open_results(folder)
    write_condensed(condense(folder, results.facts, times_s=results.times_s), folder, results.provenance)
    return results


def keep(house: House, results: Results) -> UUID:
    """Put the results where a run leaves them, and the rows that say so."""
    store = ObjectStore(house.app.state.platform.settings.object_store_url)
    with house.context.sessions.begin() as session:
        run = keep_run(session, results)
        keep_frames(session, store, run, results.n_frames)
        for task, start, stop, files in _products(results):
            product = keep_product(session, run, task, range(start, stop), sorted(files))
            for name, content in files.items():
                store.put(product.prefix + name, content)
        return run.id


def _products(results: Results) -> Iterator[tuple[str, int, int, dict[str, Path | bytes]]]:
    """Task, frames, and files of each product of a run."""
    n_frames, folder = results.n_frames, results.folder
    shape = (HEIGHT_PX, WIDTH_PX)
    measured = StackEstimate(shape, np.ones(shape, np.float32))
    measured.save(folder / ESTIMATE_FILE)
    yield "prepare", 0, n_frames, {ESTIMATE_FILE: folder / ESTIMATE_FILE}
    for start in range(0, n_frames, _FRAMES_A_SHARD):
        stop = min(start + _FRAMES_A_SHARD, n_frames)
        part = folder / f"droplets-{start}.parquet"
        rows = pq.read_table(results.droplets, filters=[("frame", ">=", start), ("frame", "<", stop)])
        pq.write_table(rows, part, compression="zstd")
        yield "detect", start, stop, {"droplets.parquet": part}
    flow = {path.relative_to(folder).as_posix(): path for path in results.flow.rglob("*") if path.is_file()}
    yield (
        "track",
        0,
        n_frames,
        {
            "trajectories.parquet": results.trajectories,
            **quality_files(results),
            **flow,
        },
    )
    example = make_example(noise(), n_frames // 2, Droplets.empty(), results.experiment, results.parameters, measured)
    example.save(folder / EXAMPLE_FILE)
    yield "analyse", 0, n_frames, {name: folder / name for name in (*FILES, EXAMPLE_FILE)}


def asked_for(n_frames: int) -> Iterator[tuple[str, str]]:
    """What is asked for: a name and an address below that of the run."""
    middle, trajectory = n_frames // 2 + 5, n_frames // 2 * 25
    queries = dict.fromkeys(("forward_tracking", "backward_tracking"), f"?frame={middle}&trajectory={trajectory}")
    queries |= dict.fromkeys(("flow_field", "displacement"), f"?frame={middle}")
    for entry in CATALOGUE:
        yield entry.name, f"figures/{entry.name}{queries.get(entry.name, '')}"
    for name in ("thresholding", "watershed", "match"):
        yield f"{name} of a frame", f"figures/{name}?frame={middle}"
    yield "moments of a range", f"figures/moments?from_s=100&to_s={n_frames // 2}"
    for which in ("detected", "tracked"):
        yield f"droplets {which}", f"frames/{middle}/droplets?which={which}"
    yield "flow of a frame", f"frames/{middle}/flow"
    yield "tails", f"frames/{middle}/tails?n_frames=10"
    yield "quality", "quality"
    yield "quality of a range of radius", "quality?radius_min_um=6&radius_max_um=12"
    yield "catalogue", "figures"


def measure(house: House, run_id: UUID, n_frames: int, n_times: int) -> list[str]:
    """Print the times; return what is too slow."""
    slow = []
    print(f"{'':<28}{'median':>9}{'largest':>9}   (ms, of {n_times})")
    for name, path in asked_for(n_frames):
        if house.api.get(f"runs/{run_id}/{path}").json().get("code") == "results.not_of_this_film":
            continue
        times_ms = []
        for _ in range(n_times):
            house.app.state.kept = Kept(0)
            kept_arrays.cache_clear()
            began = time.perf_counter()
            house.api.get(f"runs/{run_id}/{path}").raise_for_status()
            times_ms.append((time.perf_counter() - began) * 1e3)
        median = statistics.median(times_ms)
        print(f"{name:<28}{median:>9.0f}{max(times_ms):>9.0f}", flush=True)
        slow += [name] if median > LIMIT_MS else []
    return slow


if __name__ == "__main__":
    main()
