"""Task detect: the droplets of a range of frames."""

import io

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from backend.platform.object_store import product_prefix
from backend.platform.packing import pack
from dropflow import pipeline
from dropflow.statistics.histograms import FrameHistograms, frame_histograms, radius_edges_um
from worker.context import Context
from worker.film import PreparedFilm, load_prepared
from worker.keys import detection_key
from worker.leases import Lease
from worker.outcomes import NewProduct, publish
from worker.speed import remember

DROPLETS_FILE = "droplets.parquet"


def work(context: Context, lease: Lease) -> None:
    """Detect, write the table and count the droplets by size."""
    claim = lease.claim
    film = load_prepared(context, claim)
    frames = range(claim.start_frame, claim.stop_frame)
    with film.frames() as stack:
        table = pipeline.detect_range(
            stack,
            film.index,
            film.experiment,
            film.parameters,
            film.measured,
            start=frames.start,
            stop=frames.stop,
            progress=lease,
        )
    prefix = product_prefix(claim.experiment_id, claim.shard_id, claim.fence)
    context.store.put(prefix + DROPLETS_FILE, _parquet(table))
    detection = detection_key(film.index, film.experiment, film.parameters)
    publish(context, claim, NewProduct(prefix, sizes=pack(count(film, table, frames)), film_key=detection))
    remember(context, film.parameters, lease.pace, n_pixels=film.index.n_rows * film.index.n_columns)


def count(film: PreparedFilm, table: pa.Table, frames: range) -> FrameHistograms:
    """Droplets of each frame by radius."""
    detection = film.parameters.detection
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    return frame_histograms(table, edges_um, frames, np.array(film.index.times_s[frames.start : frames.stop]))


def _parquet(table: pa.Table) -> bytes:
    packed = io.BytesIO()
    pq.write_table(table, packed)
    return packed.getvalue()
