"""A simulated film as a folder: frames, flat field, truth and experiment.yaml, as `dropflow analyse` reads them."""

import contextlib
import shutil
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import tifffile
import yaml

from dropflow.errors import FieldProblem, ParametersError, ResultsError
from dropflow.progress import Progress, silent
from dropflow.provenance import code_version
from dropflow.simulation.cloud import Cloud
from dropflow.simulation.events import EventLog
from dropflow.simulation.film import Film, Moment, moments_of_paths
from dropflow.simulation.render import Renderer
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.truth import TRUTH, Visibility
from dropflow.tracking.flow import FlowField
from dropflow.tracking.flow_store import STEPS_PER_CHUNK, FlowStore, create_flow_store

_FRAMES_PER_ROW_GROUP = 64

FlowAt = Callable[[float], npt.NDArray[np.float64]]
"""The flow at the centres of the scenario's grid at a time in seconds: shape (2, n_rows, n_columns), um/s."""


def write_experiment(
    out: Path, film: Film, n_frames: int, *, with_images: bool = True, progress: Progress = silent
) -> None:
    """Simulate `n_frames` frames and write them with their truth into the new folder `out`.

    Writes ``frames/*.tif``, ``flat_field.tif`` (both only `with_images`), ``truth.parquet``
    (`dropflow.simulation.truth.TRUTH`), ``truth_flow.zarr`` (the layout of ``flow.zarr``: the exact flow at the
    centres of the cells, in the middle between two frames), ``events.csv``, ``experiment.yaml`` and ``scenario.yaml``
    (every constant and the seed). Nothing is left if it fails. Memory does not depend on `n_frames`.

    Raises
    ------
    ParametersError
        Where `n_frames` is less than 1, or no droplet could be visible.
    ResultsError
        Where `out` is a file or a folder with something in it, or cannot be written.
    """
    scenario, flow = film.scenario, film.flow

    def flow_at(time_s: float) -> npt.NDArray[np.float64]:
        return flow.on_grid(scenario.grid, pixel_size_um=scenario.pixel_size_um, time_s=time_s)

    _write(out, film, film.moments(n_frames), n_frames, flow_at, with_images, progress)


def render_positions(
    out: Path,
    scenario: Scenario,
    clouds: Iterable[Cloud],
    n_frames: int,
    *,
    seed: int,
    flow_at: FlowAt | None = None,
    with_images: bool = True,
    progress: Progress = silent,
) -> None:
    """Write an experiment as `write_experiment` does, with droplets on given paths: one `Cloud` a frame.

    Velocities in the truth are displacements to the next frame (where there is none, from the frame before), and the
    flow's part is what the Stokes speed leaves. Without `flow_at` there is no ``truth_flow.zarr``.
    """
    film = Film(scenario, seed)
    _write(out, film, moments_of_paths(clouds, scenario), n_frames, flow_at, with_images, progress)


def _write(
    out: Path,
    film: Film,
    moments: Iterable[Moment],
    n_frames: int,
    flow_at: FlowAt | None,
    with_images: bool,
    progress: Progress,
) -> None:
    if n_frames < 1:
        raise ParametersError("Please correct:", fields=[FieldProblem("frames", "must be at least 1")])
    scenario = film.scenario
    with _new_folder(out) as folder, contextlib.ExitStack() as stack:
        _write_documents(folder, film, n_frames, with_images=with_images)
        write_frame = _frame_writer(folder, Renderer(scenario, film.seed)) if with_images else None
        write_truth = stack.enter_context(_truth_writer(folder / "truth.parquet"))
        write_flow = stack.enter_context(_flow_writer(folder, film, n_frames, flow_at)) if flow_at else None
        events = EventLog(stack.enter_context((folder / "events.csv").open("w", encoding="utf-8")), scenario)
        for moment in moments:
            truth = moment.truth(scenario)
            write_truth(truth)
            events.add(moment, truth)
            if write_flow and moment.frame + 1 < n_frames:
                write_flow(moment.time_s, truth)
            if write_frame:
                write_frame(moment)
            progress("simulate", moment.frame + 1, n_frames)


@contextlib.contextmanager
def _new_folder(out: Path) -> Iterator[Path]:
    """A folder beside `out` that becomes `out` when all went well, and is removed otherwise."""
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise ResultsError(
            "This is there already.", code="results.exists", file=str(out), hint="Choose a new folder, or empty it."
        )
    part = out.with_name(out.name + ".part")
    try:
        if part.exists():
            shutil.rmtree(part)
        part.mkdir(parents=True)
        yield part
        if out.exists():
            out.rmdir()
        part.rename(out)
    except OSError as problem:
        raise ResultsError(f"The folder cannot be written ({problem.strerror}).", file=str(out)) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _write_documents(folder: Path, film: Film, n_frames: int, *, with_images: bool) -> None:
    experiment = film.scenario.experiment(seed=film.seed, is_with_flat_field=with_images)
    about = {"dropflow_version": code_version(), "seed": film.seed, "n_frames": n_frames}
    documents = {
        "experiment.yaml": experiment.model_dump(mode="json", exclude_none=True),
        "scenario.yaml": {**about, "scenario": film.scenario.model_dump(mode="json")},
    }
    for name, content in documents.items():
        (folder / name).write_text(yaml.safe_dump(content, sort_keys=False, allow_unicode=True), encoding="utf-8")


def _frame_writer(folder: Path, renderer: Renderer) -> Callable[[Moment], None]:
    (folder / "frames").mkdir()
    tifffile.imwrite(folder / "flat_field.tif", renderer.flat_field())

    def write(moment: Moment) -> None:
        name = f"frame_{moment.frame:06d}.tif"
        tifffile.imwrite(folder / "frames" / name, renderer.frame(moment.cloud, moment.frame))

    return write


@contextlib.contextmanager
def _truth_writer(path: Path) -> Iterator[Callable[[pa.Table], None]]:
    waiting: list[pa.Table] = []
    with pq.ParquetWriter(path, TRUTH, compression="zstd") as writer:

        def write(rows: pa.Table) -> None:
            waiting.append(rows)
            if len(waiting) == _FRAMES_PER_ROW_GROUP:
                writer.write_table(pa.concat_tables(waiting))
                waiting.clear()

        yield write
        if waiting:
            writer.write_table(pa.concat_tables(waiting))


@contextlib.contextmanager
def _flow_writer(
    folder: Path, film: Film, n_frames: int, flow_at: FlowAt
) -> Iterator[Callable[[float, pa.Table], None]]:
    scenario = film.scenario
    grid, interval_s = scenario.grid, scenario.frame_interval_s
    about: dict[str, Any] = {"dropflow_version": code_version(), "seed": film.seed, "scenario": scenario.name}
    times_s = interval_s * np.arange(n_frames, dtype=np.float64)
    store = create_flow_store(folder / "truth_flow.zarr", grid, times_s, about=about)
    flows = FlowStore(store)
    waiting: list[FlowField] = []
    n_written = 0

    def flush() -> None:
        nonlocal n_written
        if waiting:
            flows.write(n_written, waiting)
        n_written += len(waiting)
        waiting.clear()

    def write(time_s: float, truth: pa.Table) -> None:
        velocity = flow_at(time_s + 0.5 * interval_s)
        visible = truth.filter(pc.equal(truth["visibility"], Visibility.VISIBLE.value))
        cells = grid.cell_of(visible["x_px"].to_numpy(), visible["y_px"].to_numpy())
        count = np.bincount(cells, minlength=grid.n_rows * grid.n_columns).reshape(grid.n_rows, grid.n_columns)
        waiting.append(FlowField(grid, velocity, np.zeros_like(velocity), count, np.zeros(count.shape, bool)))
        if len(waiting) == STEPS_PER_CHUNK:
            flush()

    yield write
    flush()
