"""A completed run in a service's database and object store, as workers leave it, from a folder of results."""

from uuid import uuid4

import cv2
import numpy as np
from sqlalchemy.orm import Session

from backend.models import File, Product, Run, Shard, Stage
from backend.models.states import ShardState, StageState
from backend.people.service import LOCAL_GROUP_ID
from backend.platform.object_store import QUALITY_BY_RADIUS_FILE, QUALITY_FILE, ObjectStore, product_prefix
from backend.platform.packing import pack
from benchmarks.statistics_speed import HEIGHT_PX, WIDTH_PX
from dropflow.results import Results
from dropflow.statistics.histograms import radius_edges_um
from dropflow.statistics.quality import film_quality
from tests.completed import completed_run

STAGES = ("detect", "track", "analyse")


def keep_run(session: Session, results: Results) -> Run:
    """An experiment whose frames are ready, and a run of it that is through with every stage."""
    n_frames = results.n_frames
    document = results.provenance["experiment"] | {"name": f"{n_frames} frames"}
    return completed_run(
        session,
        LOCAL_GROUP_ID,
        document,
        (HEIGHT_PX, WIDTH_PX),
        n_frames,
        parameters=results.provenance["parameters"],
        summary={**results.summary, "duration_s": n_frames - 1.0},
        stages=[
            Stage(name=name, position=position, state=StageState.COMPLETED, total_frames=n_frames)
            for position, name in enumerate(STAGES)
        ],
    )


def keep_product(session: Session, run: Run, task: str, frames: range, names: list[str]) -> Product:
    """What a task made of a range of frames; its files belong below the prefix that it has."""
    shard_id = uuid4()
    product = Product(
        experiment_id=run.experiment_id,
        task=task,
        input_key=f"{task}-{frames.start}",
        start_frame=frames.start,
        stop_frame=frames.stop,
        prefix=product_prefix(run.experiment_id, shard_id, 1),
        files=[{"name": name, "size_bytes": 0, "media_type": "application/octet-stream"} for name in names],
    )
    session.add(product)
    session.flush()
    shard = Shard(
        id=shard_id,
        experiment_id=run.experiment_id,
        run_id=run.id,
        task=task,
        start_frame=frames.start,
        stop_frame=frames.stop,
        done_frames=len(frames),
        state=ShardState.COMPLETED,
        product_id=product.id,
        fence=1,
    )
    session.add(shard)
    return product


def quality_files(results: Results) -> dict[str, bytes]:
    """What tracking leaves of how well it did."""
    detection = results.parameters.detection
    edges_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    of_frames, by_radius = film_quality(results.folder, results.times_s, results.experiment, edges_um)
    return {QUALITY_FILE: pack(of_frames), QUALITY_BY_RADIUS_FILE: pack(by_radius)}


def keep_frames(session: Session, store: ObjectStore, run: Run, n_frames: int) -> None:
    """One image of noise under the names of all frames: only its size matters here."""
    content = cv2.imencode(".tif", noise(), [cv2.IMWRITE_TIFF_COMPRESSION, 1])[1].tobytes()
    store.put("frame.tif", content)
    session.add_all(
        File(
            experiment_id=run.experiment_id,
            role="frames",
            name=f"{index:06d}.tif",
            size_bytes=len(content),
            sha256="0" * 64,
            store_key="frame.tif",
        )
        for index in range(n_frames)
    )


def noise() -> np.ndarray:
    """A frame of the film's size."""
    return np.random.default_rng(0).integers(20, 60, (HEIGHT_PX, WIDTH_PX), np.uint8)
