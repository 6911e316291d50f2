"""A completed run of a long film, as workers leave it, from tables that are made up: one image for all frames."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from uuid import UUID

from backend.models import FrameSummary
from backend.platform.packing import pack
from backend.platform.settings import Settings
from benchmarks.completed_run import keep_frames, keep_product, keep_run, quality_files
from benchmarks.statistics_speed import write_tables
from dropflow.results import Results, open_results
from dropflow.statistics.condense import condense
from dropflow.statistics.condensed_files import FILES, write_condensed
from dropflow.statistics.flow_moments import flow_moments
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.table_histograms import histograms_after_tracking, histograms_of_table
from worker.context import Context, make_context

_SETTINGS = ("database_url", "redis_url", "object_store_url", "work_dir")


def make_run(variables: Mapping[str, str], folder: Path, n_frames: int, n_droplets: int) -> UUID:
    """Write the tables into the object store and the rows into the database of a service; the id of the run."""
    write_tables(folder, n_frames, n_droplets)
    results = open_results(folder)
    write_condensed(condense(folder, results.facts, times_s=results.times_s), folder, results.provenance)
    told: dict[str, Any] = {name: variables[name.upper()] for name in _SETTINGS}
    return _keep(make_context(Settings(**told)), results)


def _keep(context: Context, results: Results) -> UUID:
    """As `worker.outcomes` writes it; here a task is one shard."""
    times_s, experiment = results.times_s, results.experiment
    flow = {path.relative_to(results.folder).as_posix(): path for path in results.flow.rglob("*") if path.is_file()}
    files: dict[str, dict[str, Path | bytes]] = {
        "detect": {"droplets.parquet": results.droplets},
        "track": {
            "trajectories.parquet": results.trajectories,
            **quality_files(results),
            **flow,
        },
        "analyse": {name: results.folder / name for name in FILES},
    }
    moments = pack(flow_moments(results.flow, experiment.up))
    with context.sessions.begin() as session:
        run = keep_run(session, results)
        keep_frames(session, context.store, run, results.n_frames)
        for task, contents in files.items():
            names = [] if task == "track" else sorted(contents)
            product = keep_product(session, run, task, range(results.n_frames), names)
            for name, content in contents.items():
                context.store.put(product.prefix + name, content)
            if task != "analyse":
                sizes = pack(_counted(task, results, times_s))
                session.add(FrameSummary(product_id=product.id, sizes=sizes, flow=moments if task == "track" else None))
        return run.id


def _counted(task: str, results: Results, times_s: Any) -> FrameHistograms:
    detection = results.parameters.detection
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    if task == "detect":
        return histograms_of_table(results.droplets, edges_um, times_s)
    return histograms_after_tracking(results.folder, edges_um, times_s, pixel_size_um=results.experiment.pixel_size_um)
