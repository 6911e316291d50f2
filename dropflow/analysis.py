"""A whole analysis on one machine: the stages of `dropflow.pipeline` over a stack, detection in several processes.

Work in progress stands in a hidden folder beside the results under a key of what goes in. A killed analysis that is
started again goes on from there; results appear whole or not at all.
"""

import json
import multiprocessing
import os
import shutil
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from dropflow import pipeline
from dropflow.detections import write_droplets
from dropflow.errors import DropflowError, ExperimentError, FieldProblem
from dropflow.experiment import Experiment
from dropflow.frames import Choice, Frame, open_frames, open_image
from dropflow.ingest import StackIndex, check_frames, index_stack
from dropflow.parameters import Parameters
from dropflow.physics.over_time import material_over_time
from dropflow.preprocess import StackEstimate
from dropflow.progress import Progress, silent
from dropflow.provenance import content_key, provenance

_FRAMES_PER_SHARD = 8


@dataclass(frozen=True)
class Film:
    """A stack, what is known of it, and how it is to be analysed: all that a process needs to take part."""

    source: Path
    experiment: Experiment
    parameters: Parameters
    index: StackIndex
    measured: StackEstimate
    temperature_log: Path | None = None
    """The file that the experiment names."""

    @property
    def choice(self) -> Choice:
        """Which images are its frames."""
        return Choice.of(self.experiment, self.index.broken_frames)

    @property
    def key(self) -> str:
        """Address of everything made from this film."""
        return content_key(
            self.index.sha256, self.experiment.model_dump(mode="json"), self.parameters.model_dump(mode="json")
        )


def open_film(
    source: Path, experiment: Experiment, parameters: Parameters, *, beside: Path, progress: Progress = silent
) -> Film:
    """Index the stack and measure what is measured once. Files that the experiment names are looked up in `beside`."""
    paths = _attached_files(experiment, beside)
    with ExitStack() as opened:
        attachments = {field: opened.enter_context(path.open("rb")) for field, path in paths.items()}
        index = index_stack(source, experiment, attachments=attachments, progress=progress)
    material_over_time(experiment, index.n_frames, index.temperatures_c)  # what is wrong with it, before hours of work
    flat_field = flat_field_beside(experiment, beside)
    if experiment.max_failed_frame_share > 0:
        with open_frames(source, Choice.of(experiment)) as frames:
            index = index.checked(
                check_frames(frames, progress=progress, max_share_broken=experiment.max_failed_frame_share)
            )
    with open_frames(source, Choice.of(experiment, index.broken_frames)) as frames:
        measured = pipeline.estimate(frames, experiment, parameters, flat_field=flat_field)
    return Film(source, experiment, parameters, index, measured, paths.get("temperature_log"))


def flat_field_beside(experiment: Experiment, beside: Path) -> Frame | None:
    """The flat field that the experiment names, looked up in the folder `beside`."""
    paths = _attached_files(experiment, beside)
    return open_image(paths["flat_field"]) if "flat_field" in paths else None


def detect(film: Film, output: Path, *, n_processes: int, progress: Progress = silent) -> None:
    """Detect the droplets of every frame and write the table `output`."""
    with _work_folder(output.parent, f"detect-{film.key[:16]}") as work:
        _detect_into(film, work, n_processes, progress)
        (work / "droplets.parquet").replace(output)


def analyse(film: Film, output: Path, *, n_processes: int, progress: Progress = silent) -> None:
    """Run every stage and leave `dropflow.pipeline.RESULT_FILES` in the folder `output`."""
    with _work_folder(output, f"analyse-{film.key[:16]}") as work:
        _detect_into(film, work, n_processes, progress)
        with open_frames(film.source, film.choice) as frames:
            pipeline.track_film(
                frames,
                film.index,
                film.experiment,
                film.parameters,
                film.measured,
                droplets=work / "droplets.parquet",
                folder=work,
                progress=progress,
            )
            pipeline.analyse_film(
                frames,
                film.index,
                film.experiment,
                film.parameters,
                film.measured,
                tables=work,
                folder=work,
                progress=progress,
            )
            progress("analyse", 1, 1)
        if film.temperature_log is not None:
            shutil.copyfile(film.temperature_log, output / pipeline.TEMPERATURE_FILE)
        for name in pipeline.RESULT_FILES:
            _replace(work / name, output / name)


def _detect_into(film: Film, work: Path, n_processes: int, progress: Progress) -> None:
    """Fill ``droplets.parquet`` in `work`, shard by shard; shards that are there already are not done again."""
    table = work / "droplets.parquet"
    if table.exists():
        return
    n_frames = film.index.n_frames
    shards = {start: work / f"shard-{start:08d}.parquet" for start in range(0, n_frames, _FRAMES_PER_SHARD)}
    missing = [start for start, path in shards.items() if not path.exists()]
    n_done = sum(_stop(film, start) - start for start in shards if start not in missing)
    progress("detect", n_done, n_frames)
    for start in _detect_shards(film, {start: shards[start] for start in missing}, n_processes):
        n_done += _stop(film, start) - start
        progress("detect", n_done, n_frames)
    about = {"dropflow": json.dumps(provenance(film.experiment, film.parameters, film.index))}
    unfinished = work / "droplets.unfinished"
    write_droplets(unfinished, (pq.read_table(shards[start]) for start in sorted(shards)), metadata=about)
    unfinished.replace(table)


def _stop(film: Film, start: int) -> int:
    return min(start + _FRAMES_PER_SHARD, film.index.n_frames)


def _detect_shards(film: Film, missing: dict[int, Path], n_processes: int) -> Iterator[int]:
    """Do the missing shards in processes (or here, for one); yield the start of each that is done."""
    if n_processes == 1 or len(missing) <= 1:
        for start, path in missing.items():
            _detect_shard(film, start, path)
            yield start
        return
    pool = ProcessPoolExecutor(
        min(n_processes, len(missing)),
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_take_part,
        initargs=(film,),
    )
    try:
        running = {pool.submit(_detect_shard, None, start, path): start for start, path in missing.items()}
        for done in as_completed(running):
            done.result()
            yield running[done]
    except BrokenProcessPool:
        raise DropflowError(
            "A detection process was ended from outside.",
            code="run.process_died",
            hint="Most often memory ran out: try fewer --jobs. Started again, the analysis goes on where it was.",
        ) from None
    finally:
        pool.shutdown(cancel_futures=True)


_film_of_this_process: Film | None = None


def _take_part(film: Film) -> None:
    """Give a new process its film once, for the flat field in it is as large as a frame."""
    global _film_of_this_process  # noqa: PLW0603 - the only thing a pool can hand to all tasks of a process
    _film_of_this_process = film


def _detect_shard(given: Film | None, start: int, path: Path) -> None:
    film = given or _film_of_this_process
    assert film is not None  # noqa: S101 - `_take_part` ran before any task of this process
    with open_frames(film.source, film.choice) as frames:
        stop = _stop(film, start)
        table: pa.Table = pipeline.detect_range(
            frames, film.index, film.experiment, film.parameters, film.measured, start=start, stop=stop
        )
    unfinished = path.with_suffix(".unfinished")
    pq.write_table(table, unfinished)
    unfinished.replace(path)


@contextmanager
def _work_folder(beside: Path, name: str) -> Iterator[Path]:
    """A hidden folder in `beside` that stays when the process is killed or stopped, and goes after success or error."""
    is_new = not beside.exists()
    work = beside / f".dropflow-{name}"
    work.mkdir(parents=True, exist_ok=True)
    try:
        yield work
    except DropflowError:
        shutil.rmtree(work)
        if is_new:
            beside.rmdir()
        raise
    shutil.rmtree(work)


def _replace(made: Path, final: Path) -> None:
    """Put a file or folder in its place, where an older one may stand."""
    if final.is_dir():
        shutil.rmtree(final)
    made.replace(final)


def _attached_files(experiment: Experiment, beside: Path) -> dict[str, Path]:
    """The files that the experiment names, by field."""
    named = {field: getattr(experiment, field) for field in ("flat_field", "timestamps", "temperature_log")}
    paths = {field: beside / name for field, name in named.items() if name is not None}
    missing = [FieldProblem(field, f"there is no file {path}") for field, path in paths.items() if not path.is_file()]
    if missing:
        raise ExperimentError("Please correct:", fields=missing)
    return paths


def available_processes() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
