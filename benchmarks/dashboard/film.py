"""A completed run of a long film, as workers leave it, from tables that are made up: no frames, no analysis."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from uuid import UUID, uuid4

import numpy as np
import pyarrow.parquet as pq

from backend.models import Experiment, FrameSummary, Product, Run, Shard, Stack, Stage
from backend.models.states import RunState, ShardState, StackState, StageState
from backend.people.service import LOCAL_GROUP_ID
from backend.platform.object_store import QUALITY_FILE, product_prefix
from backend.platform.packing import pack
from backend.platform.settings import Settings
from benchmarks.statistics_speed import HEIGHT_PX, WIDTH_PX, write_tables
from dropflow.results import open_results
from dropflow.statistics.condense import condense
from dropflow.statistics.condensed_files import FILES, write_condensed
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_moments import flow_moments
from dropflow.statistics.histograms import FrameHistograms, frame_histograms, radius_edges_um
from dropflow.statistics.quality import frame_quality
from worker.context import Context, make_context

TASKS = ("detect", "track", "analyse")


def make_run(variables: Mapping[str, str], folder: Path, n_frames: int, n_droplets: int) -> UUID:
    """Write the tables into the object store and the rows into the database of a service; the id of the run."""
    write_tables(folder, n_frames, n_droplets)
    results = open_results(folder)
    condensed = condense(folder, results.facts, times_s=results.times_s)
    write_condensed(condensed, folder, results.provenance)
    told: dict[str, Any] = {name: variables[name.upper()] for name in _SETTINGS}
    context = make_context(Settings(**told))
    return _rows(context, folder, results.facts, results.summary, n_frames)


_SETTINGS = ("database_url", "redis_url", "object_store_url", "work_dir")


def _rows(context: Context, folder: Path, facts: FilmFacts, summary: Mapping[str, Any], n_frames: int) -> UUID:
    """As `worker.outcomes` writes them, shard by shard; here a task is one shard."""
    times_s = np.arange(n_frames, dtype=float)
    document = facts.experiment.model_dump(mode="json") | {"name": f"{n_frames} frames"}
    with context.sessions.begin() as session:
        stack = Stack(
            state=StackState.READY,
            n_frames=n_frames,
            rows=HEIGHT_PX,
            columns=WIDTH_PX,
            dtype="uint8",
            duration_s=n_frames - 1.0,
            checksum="0" * 64,
        )
        experiment = Experiment(group_id=LOCAL_GROUP_ID, document=document, stack=stack)
        session.add(experiment)
        session.flush()
        run = Run(
            experiment_id=experiment.id,
            number=1,
            state=RunState.COMPLETED,
            parameters=facts.parameters.model_dump(mode="json"),
            document=document,
            version="0",
            summary={**summary, "duration_s": n_frames - 1.0},
            stages=[
                Stage(name=name, position=position, state=StageState.COMPLETED, total_frames=n_frames)
                for position, name in enumerate(TASKS)
            ],
        )
        session.add(run)
        session.flush()
        for task in TASKS:
            shard_id = uuid4()
            prefix = product_prefix(experiment.id, shard_id, 1)
            product = Product(
                experiment_id=experiment.id,
                task=task,
                input_key=task,
                start_frame=0,
                stop_frame=n_frames,
                prefix=prefix,
                files=[],
            )
            session.add(product)
            session.flush()
            done = Shard(
                id=shard_id,
                experiment_id=experiment.id,
                run_id=run.id,
                task=task,
                stop_frame=n_frames,
                done_frames=n_frames,
                state=ShardState.COMPLETED,
                product_id=product.id,
                fence=1,
            )
            session.add(done)
            _store(context, folder, task, prefix, facts, times_s)
            if task != "analyse":
                table = folder / ("droplets.parquet" if task == "detect" else "trajectories.parquet")
                sizes = pack(_counted(table, facts, times_s))
                flow = pack(flow_moments(folder / "flow.zarr", facts.experiment.up)) if task == "track" else None
                session.add(FrameSummary(product_id=product.id, sizes=sizes, flow=flow))
        return run.id


def _counted(table: Path, facts: FilmFacts, times_s: Any) -> FrameHistograms:
    detection = facts.parameters.detection
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    frames, file = range(len(times_s)), pq.ParquetFile(table)
    total = frame_histograms(file.schema_arrow.empty_table(), edges_um, frames, times_s)
    for group in range(file.num_row_groups):
        part = frame_histograms(file.read_row_group(group, columns=["frame", "r_um"]), edges_um, frames, times_s)
        total = replace(total, counts=total.counts + part.counts, moments=total.moments + part.moments)
    return total


def _store(context: Context, folder: Path, task: str, prefix: str, facts: FilmFacts, times_s: Any) -> None:
    if task == "detect":
        context.store.put(prefix + "droplets.parquet", folder / "droplets.parquet")
    elif task == "track":
        context.store.put(prefix + "trajectories.parquet", folder / "trajectories.parquet")
        for path in sorted(path for path in (folder / "flow.zarr").rglob("*") if path.is_file()):
            context.store.put(prefix + path.relative_to(folder).as_posix(), path)
        context.store.put(prefix + QUALITY_FILE, pack(frame_quality(folder, times_s, facts.experiment)))
    else:
        for name in FILES:
            context.store.put(prefix + name, folder / name)
