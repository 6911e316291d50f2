"""All statistics of a run of 20,000 frames with 500 droplets each: seconds of CPU and memory.

    .venv/bin/python benchmarks/statistics_speed.py [FRAMES] [DROPLETS]

The tables are made up (straight paths, no images): only their size matters here.
"""

import json
import os
import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.parameters import Parameters
from dropflow.tables import DROPLETS, TRAJECTORIES
from dropflow.tracking.events import EVENTS
from dropflow.tracking.flow_store import create_flow_store
from dropflow.tracking.grid import Grid

N_FRAMES_EACH = 20
ROWS_PER_GROUP = 1 << 16
"""As tracking writes them."""
WIDTH_PX, HEIGHT_PX, PIXEL_UM = 2448, 2058, 0.625


def write_tables(folder: Path, n_frames: int, n_droplets: int) -> None:
    """Trajectories of 20 frames, a wave of sizes every 500 frames, and a flow field of 25 x 20 cells."""
    rng = np.random.default_rng(0)
    n_each = n_droplets * 1000 // N_FRAMES_EACH
    with pq.ParquetWriter(folder / "trajectories.parquet", TRAJECTORIES, compression="zstd") as writer:
        for block in range(max(n_frames // 1000, 1)):
            writer.write_table(trajectory_rows(rng, block, n_each, min(n_frames, 1000)), ROWS_PER_GROUP)
    with (
        pq.ParquetFile(folder / "trajectories.parquet") as table,
        pq.ParquetWriter(folder / "droplets.parquet", DROPLETS, compression="zstd") as writer,
    ):
        for group in range(table.num_row_groups):
            writer.write_table(table.read_row_group(group, columns=DROPLETS.names).sort_by("frame"))
    pq.write_table(EVENTS.empty_table(), folder / "events.parquet")
    write_flow(folder / "flow.zarr", n_frames, rng)
    write_summary(folder, n_frames)


def trajectory_rows(rng: np.random.Generator, block: int, n: int, n_frames: int) -> pa.Table:
    start = np.sort(rng.integers(0, n_frames - N_FRAMES_EACH, n)) + block * 1000
    frame = (start[:, None] + np.arange(N_FRAMES_EACH)).ravel()
    radius = np.repeat(np.exp(rng.normal(np.log(6 + 10 * (start % 500) / 500), 0.3, n)), N_FRAMES_EACH)
    radius = np.clip(radius * rng.normal(1, 0.03, len(radius)), 4, 40)
    rise = 0.05 * np.repeat(radius[::N_FRAMES_EACH], N_FRAMES_EACH) ** 2
    age = np.tile(np.arange(N_FRAMES_EACH), n)
    x = np.repeat(rng.uniform(0, WIDTH_PX * PIXEL_UM, n), N_FRAMES_EACH) + 3.0 * age
    y = np.repeat(rng.uniform(0, HEIGHT_PX * PIXEL_UM, n), N_FRAMES_EACH) - rise * age
    one = np.ones(len(frame))
    columns = {
        "trajectory_id": np.repeat(np.arange(n) + block * n, N_FRAMES_EACH),
        "frame": frame.astype(np.int32),
        "time_s": frame.astype(float),
        "x_px": x / PIXEL_UM,
        "y_px": y / PIXEL_UM,
        "r_px": radius / PIXEL_UM,
        "x_um": x,
        "y_um": y,
        "r_um": radius,
        "is_detected": one.astype(bool),
        "u_um_s": 3.0 * one,
        "v_um_s": -rise,
        "sedimentation_um_s": rise,
        "r_smooth_um": radius,
        "r_smooth_std_um": 0.01 * radius,
        "is_in_focus": one.astype(bool),
    }
    return pa.table({name: columns.get(name, one) for name in TRAJECTORIES.names}, schema=TRAJECTORIES)


def write_flow(path: Path, n_frames: int, rng: np.random.Generator) -> None:
    grid = Grid(HEIGHT_PX, WIDTH_PX, 20, 25)
    store = create_flow_store(path, grid, np.arange(n_frames, dtype=float), {})
    velocity, interpolated = store["velocity_um_s"], store["is_interpolated"]
    for start in range(0, n_frames - 1, 512):
        steps = slice(start, min(start + 512, n_frames - 1))
        shape = (steps.stop - start, 2, 20, 25)
        velocity[steps] = rng.normal(0, 5, shape).astype(np.float32)
        interpolated[steps] = rng.random((shape[0], 20, 25)) < 0.2


def write_summary(folder: Path, n_frames: int) -> None:
    experiment = {
        "name": "speed",
        "pixel_size_um": PIXEL_UM,
        "frame_interval_s": 1.0,
        "droplets": "bright",
        "material": {"delta_density_kg_m3": -25.0, "viscosity_pa_s": 1e-3},
    }
    summary = {
        "n_frames": n_frames,
        "duration_s": n_frames - 1.0,
        "field_of_view_um": [WIDTH_PX * PIXEL_UM, HEIGHT_PX * PIXEL_UM],
        "detected": {"n_droplets": 0},
        "tracked": {"n_droplets": 0, "mean_radius_um": None, "sauter_radius_um": None, "n_counted": 0.0},
        "provenance": {
            "dropflow_version": "0",
            "experiment": experiment,
            "parameters": Parameters().model_dump(mode="json"),
            "input_sha256": "0",
        },
    }
    (folder / "summary.json").write_text(json.dumps(summary))


def _peak_gb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def _peaks(_stage: str, done: int, total: int) -> None:
    print(f"  {done} of {total}: peak {_peak_gb():.2f} GB")


def _time_figures(results: Any) -> None:
    """As the service does: each figure by itself, from what the analysis left."""
    from dropflow.figures.catalogue import CATALOGUE
    from dropflow.figures.entry import draw
    from dropflow.statistics.condensed_files import StoredCondensed
    from dropflow.statistics.findings import Findings

    for round_number in range(2):  # what is loaded and compiled at the first use is not counted
        for entry in CATALOGUE:
            if entry.drawing.draw is None or entry.drawing.missing(results.facts):
                continue
            begin_s = time.perf_counter()
            stored = StoredCondensed(lambda name: (results.folder / name).open("rb"))
            content = draw(entry, Findings(results.facts, stored)).to_json()
            took_ms = 1e3 * (time.perf_counter() - begin_s)
            if round_number:
                print(f"  {entry.name:<26} {took_ms:6.0f} ms {len(content) / 1e3:8.0f} kB")


def main() -> None:
    n_frames, n_droplets = (int(word) for word in (*sys.argv[1:], "20000", "500")[:2])
    folder = Path(tempfile.mkdtemp())
    try:
        if os.fork() == 0:  # the tables are made in a process of its own, so that its memory is not counted
            write_tables(folder, n_frames, n_droplets)
            os._exit(0)
        os.wait()
        from dropflow.results import open_results
        from dropflow.statistics.condense import condense
        from dropflow.statistics.condensed_files import write_condensed

        results = open_results(folder)
        begin_s, wall_s = time.process_time(), time.perf_counter()
        condensed = condense(folder, results.facts, times_s=results.times_s, progress=_peaks)
        print(f"statistics: {time.process_time() - begin_s:.1f} s of CPU, {time.perf_counter() - wall_s:.1f} s")
        print(f"peak memory {_peak_gb():.2f} GB")
        write_condensed(condensed, folder, results.provenance)
        _time_figures(open_results(folder))
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
