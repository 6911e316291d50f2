"""The stages of an analysis as functions over a range of frames: ingest, detect, track, analyse.

The command runs them in processes (`dropflow.analysis`), the service in shards: nothing of an analysis is written
twice. No stage keeps more than a few frames in memory.
"""

import json
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
from dropflow.figures.example import EXAMPLE_FILE, Example, make_example
from dropflow.frames import Frame, Frames
from dropflow.ingest import StackIndex, missing_warning
from dropflow.parameters import Parameters
from dropflow.preprocess import StackEstimate, estimate_stack
from dropflow.progress import Progress, silent
from dropflow.report.frames import FrameSource
from dropflow.report.page import make_report
from dropflow.statistics.condense import condense
from dropflow.statistics.condensed_files import FILES, StoredCondensed, write_condensed
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings
from dropflow.statistics.summary import statistics_of, summarise
from dropflow.tables import DROPLETS
from dropflow.tracking import track

SUMMARY_FILE = "summary.json"
REPORT_FILE = "report.html"
TEMPERATURE_FILE = "temperature_log.csv"
"""The experiment's temperature log as it was, where it names one."""
STATISTICS_FILES = (*FILES, EXAMPLE_FILE)
RESULT_FILES = (
    "droplets.parquet",
    "trajectories.parquet",
    "rejected_trajectories.parquet",
    "events.parquet",
    "flow.zarr",
    *STATISTICS_FILES,
    SUMMARY_FILE,
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

    Writes ``trajectories.parquet``, ``rejected_trajectories.parquet``, ``events.parquet`` and ``flow.zarr`` into
    `folder`, where it also keeps its checkpoints: called again after a crash, it goes on from the last one.
    """
    reader = DropletReader(droplets)
    try:
        track(
            frames,
            reader,
            times_s=np.array(index.times_s),
            temperature_c=None if index.temperatures_c is None else np.array(index.temperatures_c),
            experiment=experiment,
            parameters=parameters,
            detector=make_detector(experiment, parameters, measured),
            folder=folder,
            provenance=provenance.provenance(experiment, parameters, index),
            progress=progress,
        )
    finally:
        reader.close()


def facts_of(index: StackIndex, experiment: Experiment, parameters: Parameters) -> FilmFacts:
    """What statistics must know of a film."""
    height_um, width_um = (side * experiment.pixel_size_um for side in index.shape)
    about = provenance.provenance(experiment, parameters, index)
    return FilmFacts(experiment, parameters, (width_um, height_um), index.n_frames, about)


def analyse_film(
    frames: Frames,
    index: StackIndex,
    experiment: Experiment,
    parameters: Parameters,
    measured: StackEstimate,
    *,
    tables: Path,
    folder: Path,
    progress: Progress = silent,
) -> dict[str, Any]:
    """Condense the tables and the flow field in the folder `tables` to what figures are drawn from.

    Writes `STATISTICS_FILES` and ``summary.json`` into `folder`, and returns what is in the latter.
    """
    facts = facts_of(index, experiment, parameters)
    temperature_c = None if index.temperatures_c is None else np.array(index.temperatures_c)
    condensed = condense(tables, facts, times_s=np.array(index.times_s), temperature_c=temperature_c, progress=progress)
    write_condensed(condensed, folder, dict(facts.provenance))
    middle = index.n_frames // 2
    reader = DropletReader(tables / "droplets.parquet")
    try:
        droplets = reader(middle)
    finally:
        reader.close()
    make_example(frames[middle], middle, droplets, experiment, parameters, measured).save(folder / EXAMPLE_FILE)
    findings = Findings(facts, condensed)
    summary = {
        **summarise(tables, index, experiment, findings.material, out_of_focus=parameters.tracking.count_out_of_focus),
        "statistics": statistics_of(findings),
        "missing_frames": list(index.broken_frames),
        "warnings": [*warnings_of(measured), *missing_warning(index)],
        "provenance": facts.provenance,
    }
    unfinished = folder / f"{SUMMARY_FILE}.part"
    unfinished.write_text(json.dumps(summary, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    unfinished.replace(folder / SUMMARY_FILE)
    return summary


def write_film_report(
    index: StackIndex,
    experiment: Experiment,
    parameters: Parameters,
    summary: dict[str, Any],
    *,
    tables: Path,
    folder: Path,
) -> None:
    """Write ``report.html`` into `folder`, where `analyse_film` has left its files; `tables` as there."""
    found = Findings(facts_of(index, experiment, parameters), StoredCondensed(lambda name: (folder / name).open("rb")))
    with (folder / EXAMPLE_FILE).open("rb") as file:
        example = Example.load(file)
    source = FrameSource(tables / "trajectories.parquet", tables / "flow.zarr", example)
    page = make_report(found, summary, source).html
    unfinished = folder / f"{REPORT_FILE}.part"
    unfinished.write_text(page, encoding="utf-8")
    unfinished.replace(folder / REPORT_FILE)
