"""Tracking a whole film: the passes one after the other, each from its last checkpoint."""

import hashlib
import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.detection.contract import Detector
from dropflow.droplets import Droplets
from dropflow.experiment import Experiment
from dropflow.frames import Frames
from dropflow.parameters import Parameters, TrackingMethod
from dropflow.physics.material import resolve
from dropflow.physics.over_time import material_over_time
from dropflow.progress import Progress, silent
from dropflow.tables import TRAJECTORIES
from dropflow.tracking.assembly import events, in_groups, sorted_trajectories, write_table
from dropflow.tracking.backward_pass import BackwardPass
from dropflow.tracking.chain import Chain
from dropflow.tracking.checkpoint import Arrays, Checkpoint, Position
from dropflow.tracking.events import EVENTS, Surroundings
from dropflow.tracking.film import FRAMES_PER_PART, Film
from dropflow.tracking.filtering import Reason
from dropflow.tracking.final_pass import FinalPass, Spools
from dropflow.tracking.forward_pass import ForwardPass
from dropflow.tracking.grid import Grid
from dropflow.tracking.paper import PaperChain, PaperRules
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable import ProbableChain
from dropflow.tracking.shifts import shifts_of_flow_px, steadied_flow, steadied_rows
from dropflow.tracking.sizes import REJECTED, learn_sizes
from dropflow.tracking.stages import Stage

_DONE = "done"
_STATE_VERSION = 4
"""Of what checkpoints and spools hold: to be raised when an older one could not be gone on from."""
_N_WALKS = 4
"""Forward, backward, final, and sorting, which counts as much as another walk."""


@dataclass(frozen=True)
class TrackingResult:
    """Where the results are, and what came of it."""

    trajectories: Path
    """Rows of `dropflow.tables.TRAJECTORIES`, sorted by (trajectory_id, frame)."""
    rejected: Path
    """Rows of `dropflow.tracking.sizes.REJECTED`, sorted by trajectory_id; ids are shared with trajectories."""
    events: Path
    """Rows of `dropflow.tracking.events.EVENTS`, sorted by frame: births, coalescences and exits."""
    flow: Path
    """See `dropflow.tracking.flow_store.FlowStore`."""
    n_trajectories: int
    n_rejected: dict[str, int]
    """By reason."""
    drift_um_s: tuple[float, float]
    """Mean flow over the film along x and y."""


def track(
    frames: Frames,
    detections: Callable[[int], Droplets],
    *,
    times_s: npt.NDArray[np.float64],
    experiment: Experiment,
    parameters: Parameters,
    detector: Detector,
    folder: Path,
    temperature_c: npt.NDArray[np.float64] | None = None,
    provenance: dict[str, Any] | None = None,
    progress: Progress = silent,
) -> TrackingResult:
    """Follow the droplets of a film (sections 3.2 and 3.3), in memory that does not grow with its length.

    Parameters
    ----------
    frames : Frames
        The film. Each frame is read and prepared at most twice, once on the way forward and once back.
    detections : callable
        Gives the droplets detected in a frame.
    times_s : ndarray, float64, shape (n_frames,)
        Strictly increasing; steps may differ.
    experiment : Experiment
        Its `pixel_size_um`, `up` and `material` make velocities of displacements.
    parameters : Parameters
    detector : Detector
        Looks for droplets in the image where they are predicted.
    folder : Path
        Gets ``trajectories.parquet``, ``rejected_trajectories.parquet``, ``events.parquet`` and ``flow.zarr``, and
        keeps what is needed to go on after the process died: with the same input the results are the same bytes,
        however often it did.
    temperature_c : ndarray, float64, shape (n_frames,), optional
        Needed where the material's numbers depend on temperature: droplets are predicted with those of each frame.
    provenance : dict, optional
        JSON document that is written into each result.
    progress : Progress
        Called as ``progress("track", done, total)`` after each frame of each pass; may raise `Cancelled`.

    Raises
    ------
    ExperimentError
        Times that do not increase; a material that nobody knows.
    ResultsError
        Detections that are not finite, or no frame at all.
    """
    material = material_over_time(experiment, len(times_s), temperature_c)
    changing = None if material.is_constant else material
    film = Film(np.asarray(times_s, np.float64), detections, frames, detector, changing)
    try:
        return track_film(film, frames.shape, experiment, parameters, folder, provenance or {}, progress)
    finally:
        film.close()


def track_film(
    film: Film,
    shape: tuple[int, int],
    experiment: Experiment,
    parameters: Parameters,
    folder: Path,
    provenance: dict[str, Any],
    progress: Progress,
) -> TrackingResult:
    """As `track`, for a film that need not have images; `shape` are the rows and columns of its frames."""
    grid = Grid(*shape, parameters.flow.n_rows, parameters.flow.n_columns)
    material = film.material.mean if film.material is not None else resolve(experiment)
    motion = Motion.of(experiment, material)
    chain = make_chain(grid, motion, parameters)
    work = folder / "tracking"
    work.mkdir(parents=True, exist_ok=True)
    checkpoint = Checkpoint(work / "checkpoint.npz", _fingerprint(film, chain, provenance))
    position = checkpoint.load()
    if position is not None and position.stage == _DONE:
        return _result(folder, position.arrays)
    spools = Spools.within(work)
    final = FinalPass(film, chain, spools, work / "flow.zarr", provenance)
    stages: list[Stage] = [
        ForwardPass(film, chain, spools.found, spools.notes),
        BackwardPass(film, chain, spools.found, spools.notes, spools.linked, spools.verdicts),
        final,
    ]
    steps = _Steps(progress, film.n_frames)
    _run(stages, checkpoint, position, steps)
    pushed_um = _assemble(film, chain, final, spools, folder, provenance, steps)
    outcome = final.outcome(pushed_um)
    checkpoint.save(Position(_DONE, 0, outcome))
    spools.remove()
    shutil.rmtree(final.flow_path, ignore_errors=True)
    return _result(folder, outcome)


def make_chain(grid: Grid, motion: Motion, parameters: Parameters) -> Chain:
    """The chain of `parameters.tracking.method`."""
    match parameters.tracking.method:
        case TrackingMethod.PAPER:
            return PaperChain(PaperRules(grid, motion, parameters.tracking, parameters.flow))
        case TrackingMethod.DEFAULT:
            return ProbableChain(grid, motion, parameters.tracking, parameters.flow.divergence)


class _Steps:
    """Counts frames over all walks."""

    def __init__(self, progress: Progress, n_frames: int) -> None:
        self._progress = progress
        self._n_frames = n_frames
        self._n_done = 0

    def tick(self) -> None:
        self.reach(self._n_done + 1)

    def reach(self, n_done: int) -> None:
        self._n_done = n_done
        self._progress("track", n_done, _N_WALKS * self._n_frames)

    def reach_share_of_last(self, share: float) -> None:
        self.reach((_N_WALKS - 1) * self._n_frames + int(share * self._n_frames))


def _run(stages: list[Stage], checkpoint: Checkpoint, position: Position | None, steps: _Steps) -> None:
    """Do the stages, from the last checkpoint on, saving the state after each part."""
    names = [stage.name for stage in stages]
    current = names.index(position.stage) if position else 0
    n_done = 0
    for index, stage in enumerate(stages):
        n_turns_done = 0 if index >= current else stage.n_parts
        if position is not None and index == current:
            stage.restore(position.arrays)
            n_turns_done = position.n_parts_done
        elif index > current:
            stage.begin(stages[index - 1].state())
        n_done += sum(stage.n_frames_of(turn) for turn in range(n_turns_done))
        steps.reach(n_done)
        for turn in range(n_turns_done, stage.n_parts):
            stage.run(turn, steps.tick)
            n_done += stage.n_frames_of(turn)
            checkpoint.save(Position(stage.name, turn + 1, stage.state()))


def _assemble(
    film: Film,
    chain: Chain,
    final: FinalPass,
    spools: Spools,
    folder: Path,
    provenance: dict[str, Any],
    steps: _Steps,
) -> npt.NDArray[np.float64]:
    """Put the tables together and the flow field in its place. Done twice, it gives the same.

    Returns how far the camera's pushes moved the scene, along x and y, um.
    """
    about = {"dropflow": json.dumps(provenance)}
    n_rows = int(final.ranges[:, 4].sum())
    raw_flow = final.flow_path if final.flow_path.exists() else folder / "flow.zarr"
    shifts_px = shifts_of_flow_px(raw_flow, film.times_s, chain.motion.pixel_size_um)
    push_um_s = shifts_px * (chain.motion.pixel_size_um / np.diff(film.times_s))[:, None]

    around = Surroundings(chain.grid, chain.motion)
    happened = events(spools.kept, final.n_parts, raw_flow, shifts_px, film.times_s, around)
    write_table(folder / "events.parquet", EVENTS, in_groups(happened, EVENTS), about)
    sizes = learn_sizes(
        spools.kept,
        spools.verdicts,
        final.n_parts,
        n_frames=film.n_frames,
        events=folder / "events.parquet",
        motion=chain.motion,
    )

    def counted() -> Iterator[pa.Table]:
        n_written = 0
        for table in sorted_trajectories(spools.kept, final.ranges, final.n_parts):
            yield sizes.complete(steadied_rows(table, push_um_s))
            n_written += len(table)
            steps.reach_share_of_last(n_written / n_rows)

    write_table(folder / "trajectories.parquet", TRAJECTORIES, counted(), about)
    rejected = (sizes.judged(spools.rejected.read(part)) for part in range(final.n_parts))
    write_table(folder / "rejected_trajectories.parquet", REJECTED, in_groups(rejected, REJECTED), about)
    if final.flow_path.exists():
        steadied = final.flow_path
        if push_um_s.any():  # what was measured stays until all is done, so that all can be done again
            steadied = final.flow_path.with_name("steadied.zarr")
            steadied_flow(final.flow_path, steadied, push_um_s)
        shutil.rmtree(folder / "flow.zarr", ignore_errors=True)
        steadied.rename(folder / "flow.zarr")
    steps.reach_share_of_last(1.0)
    return np.asarray(shifts_px.sum(axis=0) * chain.motion.pixel_size_um)


def _result(folder: Path, outcome: Arrays) -> TrackingResult:
    u_um_s, v_um_s = outcome["drift_um_s"].tolist()
    return TrackingResult(
        trajectories=folder / "trajectories.parquet",
        rejected=folder / "rejected_trajectories.parquet",
        events=folder / "events.parquet",
        flow=folder / "flow.zarr",
        n_trajectories=int(outcome["n_trajectories"]),
        n_rejected=dict(zip(map(str, Reason), outcome["n_rejected"].tolist(), strict=True)),
        drift_um_s=(u_um_s, v_um_s),
    )


def _fingerprint(film: Film, chain: Chain, provenance: dict[str, Any]) -> str:
    """Of all that went in, so that a state is only gone on from with the same."""
    motion = chain.motion
    about = [
        _STATE_VERSION,
        FRAMES_PER_PART,
        hashlib.sha256(film.times_s.tobytes()).hexdigest(),
        film.frames is not None,
        [chain.grid.height_px, chain.grid.width_px],
        [motion.pixel_size_um, motion.up, motion.material.model_dump(mode="json")],
        None if film.material is None else film.material.checksum,
        [chain.grid.n_rows, chain.grid.n_columns],
        chain.settings(),
        provenance,
    ]
    return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()
