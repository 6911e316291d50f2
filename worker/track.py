"""Task track: trajectories and the flow field of the whole film, going on from where an earlier holder was."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from backend.platform.object_store import QUALITY_BY_RADIUS_FILE, QUALITY_FILE, ObjectStore, product_prefix
from backend.platform.packing import pack
from backend.platform.zip_stream import zip_stream
from dropflow import pipeline
from dropflow.detections import write_droplets
from dropflow.provenance import provenance
from dropflow.statistics.flow_moments import flow_moments
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.quality import film_quality
from dropflow.statistics.table_histograms import histograms_after_tracking
from worker.context import Context
from worker.detect import DROPLETS_FILE
from worker.downloadable import described, pieces_of
from worker.film import PreparedFilm, load_prepared, prefixes
from worker.giving_way import Turn
from worker.leases import Lease
from worker.outcomes import NewProduct, publish
from worker.plan import Task
from worker.work_folders import work_folder

TABLES = ("droplets.parquet", "trajectories.parquet", "rejected_trajectories.parquet", "events.parquet")
FLOW = "flow.zarr"
CHECKPOINT = "tracking/checkpoint.npz"
"""Where tracking saves its state in the folder that it is given."""
_PARQUET = "application/vnd.apache.parquet"


def work(context: Context, lease: Lease) -> None:
    """Join the detections, track, and publish the tables and the flow field."""
    claim = lease.claim
    film = load_prepared(context, claim)
    with context.sessions.begin() as session:
        parts = prefixes(session, film.run_id, Task.DETECT)
    with work_folder(context.settings.work_dir, claim) as folder:
        if not (folder / DROPLETS_FILE).exists():
            _join(context.store, film, parts, folder, lease)
        with film.frames() as frames:
            pipeline.track_film(
                frames,
                film.index,
                film.experiment,
                film.parameters,
                film.measured,
                droplets=folder / DROPLETS_FILE,
                folder=folder,
                progress=Turn(context, lease, folder / CHECKPOINT),
            )
        sizes = pack(_count_tracked(film, folder))
        flow = pack(flow_moments(folder / FLOW, film.experiment.up))
        prefix = product_prefix(claim.experiment_id, claim.shard_id, claim.fence)
        _store(context.store, folder, prefix, lease)
        _store_quality(context.store, film, folder, prefix)
        publish(context, claim, NewProduct(prefix, _files(folder, lease), sizes, flow))


def _join(store: ObjectStore, film: PreparedFilm, parts: list[str], folder: Path, lease: Lease) -> None:
    """All detections as one table, with where they come from."""
    about = {"dropflow": json.dumps(provenance(film.experiment, film.parameters, film.index))}
    unfinished = folder / "droplets.unfinished"
    write_droplets(unfinished, _tables(store, parts, lease), metadata=about)
    unfinished.replace(folder / DROPLETS_FILE)


def _tables(store: ObjectStore, parts: list[str], lease: Lease) -> Iterator[pa.Table]:
    for n_done, prefix in enumerate(parts):
        with store.open(prefix + DROPLETS_FILE) as file:
            yield pq.read_table(file)
        lease.alive("join", n_done, len(parts))


def _count_tracked(film: PreparedFilm, folder: Path) -> FrameHistograms:
    """The droplets that the size distribution after tracking counts; some rows are in memory at a time."""
    detection = film.parameters.detection
    return histograms_after_tracking(
        folder,
        radius_edges_um(detection.radius_min_um, detection.radius_max_um),
        np.array(film.index.times_s),
        pixel_size_um=film.experiment.pixel_size_um,
        out_of_focus=film.parameters.tracking.count_out_of_focus,
    )


def _store(store: ObjectStore, folder: Path, prefix: str, lease: Lease) -> None:
    paths = [folder / name for name in TABLES] + _flow_files(folder)
    for n_done, path in enumerate(paths):
        store.put(prefix + path.relative_to(folder).as_posix(), path)
        lease.alive("store", n_done, len(paths))


def _store_quality(store: ObjectStore, film: PreparedFilm, folder: Path, prefix: str) -> None:
    detection = film.parameters.detection
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    of_frames, by_radius = film_quality(folder, np.array(film.index.times_s), film.experiment, edges_um)
    store.put(prefix + QUALITY_FILE, pack(of_frames))
    store.put(prefix + QUALITY_BY_RADIUS_FILE, pack(by_radius))


def _flow_files(folder: Path) -> list[Path]:
    return sorted(path for path in (folder / FLOW).rglob("*") if path.is_file())


def _files(folder: Path, lease: Lease) -> list[dict[str, Any]]:
    """What can be fetched; the flow field as the very archive that the service streams: members sorted by key."""
    tables = [described(name, _PARQUET, pieces_of(folder / name), lease) for name in TABLES]
    members = sorted(path.relative_to(folder).as_posix() for path in _flow_files(folder))
    archive = zip_stream((name, (folder / name).read_bytes()) for name in members)
    return [*tables, described(f"{FLOW}.zip", "application/zip", archive, lease)]
