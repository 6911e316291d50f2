"""The stages of an analysis as functions over a range of frames: ingest, detect, track, analyse.

The command runs them in processes (`dropflow.analysis`), the service in shards: nothing of an analysis is written
twice. No stage keeps more than a few frames in memory.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from dropflow import provenance
from dropflow.detection import make_detector
from dropflow.detection.unfamiliar import unfamiliar_share, warnings_of
from dropflow.detections import DropletReader
from dropflow.experiment import Experiment
from dropflow.frames import Frame, Frames
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters
from dropflow.preprocess import StackEstimate, estimate_stack
from dropflow.progress import Progress, silent
from dropflow.statistics.summary import summarise
from dropflow.tables import DROPLETS
from dropflow.tracking import track

RESULT_FILES = (
    "droplets.parquet",
    "trajectories.parquet",
    "rejected_trajectories.parquet",
    "flow.zarr",
    "summary.json",
)
"""What a finished analysis consists of."""


def estimate(
    frames: Frames, experiment: Experiment, parameters: Parameters, *, flat_field: Frame | None = None
) -> StackEstimate:
    """What is measured once per stack before detection begins; checks also that the parameters fit the frames."""
    measured = estimate_stack(frames, experiment, parameters, flat_field)
    share = unfamiliar_share(frames, make_detector(experiment, parameters, measured))
    return replace(measured, unfamiliar_share=share)


def detect_range(
    frames: Frames,
    index: StackIndex,
    experiment: Experiment,
    parameters: Parameters,
    measured: StackEstimate,
    *,
    start: int,
    stop: int,
    progress: Progress = silent,
) -> pa.Table:
    """Detect the droplets of frames start..stop-1: rows of `dropflow.tables.DROPLETS`, sorted by frame."""
    detector = make_detector(experiment, parameters, measured)
    parts = [DROPLETS.empty_table()]
    for n_done, frame in enumerate(range(start, stop), start=1):
        found = detector.detect(detector.prepare(frames.read(frame))).droplets
        parts.append(found.to_table(frame=frame, time_s=index.times_s[frame], pixel_size_um=experiment.pixel_size_um))
        progress("detect", n_done, stop - start)
    return pa.concat_tables(parts)


def track_film(
    frames: Frames,
    index: StackIndex,
    experiment: Experiment,
    parameters: Parameters,
    measured: StackEstimate,
    *,
    droplets: Path,
    folder: Path,
    progress: Progress = silent,
) -> None:
    """Track all droplets of the table at `droplets` through the film.

    Writes ``trajectories.parquet``, ``rejected_trajectories.parquet`` and ``flow.zarr`` into `folder`, where it also
    keeps its checkpoints: called again after a crash, it goes on from the last one.
    """
    reader = DropletReader(droplets)
    try:
        track(
            frames,
            reader,
            times_s=np.array(index.times_s),
            experiment=experiment,
            parameters=parameters,
            detector=make_detector(experiment, parameters, measured),
            folder=folder,
            provenance=provenance.provenance(experiment, parameters, index),
            progress=progress,
        )
    finally:
        reader.close()


def summary(
    folder: Path, index: StackIndex, experiment: Experiment, parameters: Parameters, measured: StackEstimate
) -> dict[str, Any]:
    """The numbers of ``summary.json`` from the tables and the flow field in `folder`, with warnings and provenance."""
    return {
        **summarise(folder, index, experiment),
        "warnings": warnings_of(measured),
        "provenance": provenance.provenance(experiment, parameters, index),
    }
