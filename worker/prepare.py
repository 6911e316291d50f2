"""Task prepare: what all shards of a run share is measured once, and the frames are divided among them."""

import io
from contextlib import ExitStack

from sqlalchemy import update

from backend.models import Run
from backend.platform.object_store import product_prefix
from backend.platform.store_files import StoreFiles
from dropflow import pipeline
from dropflow.frames import Frame, open_frames
from dropflow.ingest import StackIndex, missing_warning
from dropflow.physics.over_time import material_over_time
from dropflow.preprocess import StackEstimate
from dropflow.preprocess.estimate import ESTIMATE_FILE
from worker.context import Context
from worker.fan_in import NewShard
from worker.film import INDEX_FILE, Film, load_film, made_ranges
from worker.keys import detection_key, range_key, source_digest
from worker.leases import Lease
from worker.outcomes import NewProduct, publish
from worker.plan import Task, detect_ranges
from worker.speed import known_seconds_per_megapixel


def work(context: Context, lease: Lease) -> None:
    """Store index and estimate of the film, and put its detection on the list."""
    claim = lease.claim
    film, uploaded = load_film(context, claim)
    index = _timed(context, film, uploaded)
    # What is wrong with the material or its temperatures, before hours of work.
    material_over_time(film.experiment, index.n_frames, index.temperatures_c)
    measured = _measure(context, film)
    prefix = product_prefix(claim.experiment_id, claim.shard_id, claim.fence)
    context.store.put(prefix + INDEX_FILE, index.model_dump_json().encode())
    context.store.put(prefix + ESTIMATE_FILE, _packed(measured))
    detection = detection_key(index, film.experiment, film.parameters)
    with context.sessions.begin() as session:
        said = [warning["message"] for warning in missing_warning(index)]
        session.execute(update(Run).where(Run.id == film.run_id).values(source_digest=source_digest(), warnings=said))
        seconds = known_seconds_per_megapixel(session, film.parameters) * index.n_rows * index.n_columns / 1e6
        done = made_ranges(session, claim.experiment_id, detection)
    shards = [
        NewShard(Task.DETECT, frames, range_key(detection, frames))
        for frames in detect_ranges(index.n_frames, seconds, done)
    ]
    publish(context, claim, NewProduct(prefix), shards)


def _timed(context: Context, film: Film, uploaded: StackIndex) -> StackIndex:
    """The index with the times of today: the interval may have been corrected since the upload."""
    with ExitStack() as opened:
        logs = [
            opened.enter_context(context.store.open_place(place))
            for place in film.files.get("temperature_log", {}).values()
        ]
        return uploaded.timed(film.experiment, logs[0] if logs else None)


def _measure(context: Context, film: Film) -> StackEstimate:
    with film.frames() as frames:
        return pipeline.estimate(frames, film.experiment, film.parameters, flat_field=_flat_field(context, film))


def _flat_field(context: Context, film: Film) -> Frame | None:
    files = film.files.get("flat_field")
    if not files:
        return None
    with open_frames(StoreFiles(context.store, files)) as frames:
        return frames[0]


def _packed(measured: StackEstimate) -> bytes:
    packed = io.BytesIO()
    measured.save(packed)
    return packed.getvalue()
