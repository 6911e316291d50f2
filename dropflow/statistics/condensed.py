"""What every figure of a film is drawn from: computed once from the tables, streaming, and small enough to keep.

`condense` makes it, `write_condensed` leaves it beside the tables, `StoredCondensed` reads of it what is asked for.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO, Protocol, TypeVar

import numpy as np
import numpy.typing as npt
import polars as pl
import pyarrow.parquet as pq

from dropflow.physics.over_time import MaterialOverTime, material_over_time
from dropflow.progress import Progress, silent
from dropflow.statistics.calibration import Calibration, self_calibration
from dropflow.statistics.coalescence import coalescences
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_correlation import FlowCorrelation, flow_correlation
from dropflow.statistics.flow_moments import FlowMoments, flow_moments
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.in_sight import InSight, in_sight
from dropflow.statistics.lengths import ObservedDepth, observed_depth
from dropflow.statistics.table_histograms import histograms_of_table
from dropflow.statistics.trajectories import summarise_table

Floats = npt.NDArray[np.float64]
Columns = TypeVar("Columns")
Part = TypeVar("Part")

_N_STEPS = 8

STATISTICS_FILE = "statistics.npz"
SUMMARY_FILE = "trajectory_summary.parquet"
EVENTS_FILE = "coalescences.parquet"
FILES = (STATISTICS_FILE, SUMMARY_FILE, EVENTS_FILE)

STATISTICS_COLUMNS = (
    "trajectory_id",
    "first_frame",
    "last_frame",
    "n_frames",
    "start_s",
    "end_s",
    "r_mean_um",
    "r_std_um",
    "growth_um_s",
    "rise_um_s",
    "sedimentation_um_s",
)
"""What figures need of the table of trajectories; the rest is not read for them."""

N_RADIUS_BINS = 20
_MEAN_OF_GAUSSIAN = float(np.sqrt(2 / np.pi))
"""Mean magnitude over rms."""


@dataclass(frozen=True)
class Clock:
    """When each frame was taken, and how warm it was."""

    time_s: Floats
    """Shape (n_frames,)."""
    temperature_c: Floats
    """Shape (n_frames,), or (0,) where there is no temperature log."""
    delta_density_kg_m3: Floats
    """Of droplets over fluid, shape (n_frames,)."""
    viscosity_pa_s: Floats
    """Of the fluid, shape (n_frames,)."""

    @property
    def material(self) -> MaterialOverTime:
        """The material in each frame."""
        return MaterialOverTime(self.delta_density_kg_m3, self.viscosity_pa_s)


class Condensed(Protocol):
    """The parts, each read or computed when it is first asked for."""

    @property
    def clock(self) -> Clock:
        """Times and temperatures."""
        ...

    @property
    def before(self) -> FrameHistograms:
        """All detections by frame and radius."""
        ...

    @property
    def after(self) -> FrameHistograms:
        """Droplets of the trajectories that were kept."""
        ...

    @property
    def flow(self) -> FlowMoments:
        """Mean and rms of the flow of each step."""
        ...

    @property
    def correlation(self) -> FlowCorrelation:
        """Correlation of the flow over distance and time."""
        ...

    @property
    def calibration(self) -> Calibration:
        """Density difference over viscosity from the droplets' own velocities."""
        ...

    @property
    def depth(self) -> ObservedDepth:
        """The depth in which droplets are seen, from how long they stay."""
        ...

    @property
    def seen(self) -> InSight | None:
        """How long droplets stay in sight; None while that is not known yet."""
        ...

    @property
    def trajectories(self) -> pl.DataFrame:
        """One row a trajectory."""
        ...

    @property
    def events(self) -> pl.DataFrame:
        """One row a coalescence."""
        ...


@dataclass(frozen=True)
class ComputedCondensed:
    """All parts, in memory."""

    clock: Clock
    before: FrameHistograms
    after: FrameHistograms
    flow: FlowMoments
    correlation: FlowCorrelation
    calibration: Calibration
    depth: ObservedDepth
    seen: InSight
    trajectories: pl.DataFrame
    events: pl.DataFrame


def statistics_edges_um(facts: FilmFacts, n_bins: int = N_RADIUS_BINS) -> Floats:
    """Edges of the radius bins of statistics against radius, over all radii that were looked for."""
    detection = facts.parameters.detection
    return radius_edges_um(detection.radius_min_um, detection.radius_max_um, n_bins)


def condense(
    folder: Path,
    facts: FilmFacts,
    *,
    times_s: Floats,
    temperature_c: Floats | None = None,
    progress: Progress = silent,
) -> ComputedCondensed:
    """Condense the tables and the flow field in `folder`; they are streamed.

    Parameters
    ----------
    folder
        Holds ``droplets.parquet``, ``trajectories.parquet``, ``events.parquet`` and ``flow.zarr``.
    facts
        What was filmed.
    times_s, temperature_c
        Of each frame, shape (n_frames,).
    progress
        Called as ``("analyse", steps done, steps)``; may raise `Cancelled`.
    """
    experiment = facts.experiment
    material = material_over_time(experiment, facts.n_frames, temperature_c)
    table, flow_path = folder / "trajectories.parquet", folder / "flow.zarr"
    steps = iter(range(_N_STEPS))

    def done(part: Part) -> Part:
        progress("analyse", next(steps), _N_STEPS)
        return part

    trajectories = done(summarise_table(table, experiment.up))
    detection = facts.parameters.detection
    fine_um = radius_edges_um(detection.radius_min_um, detection.radius_max_um)
    flow = done(flow_moments(flow_path, experiment.up))
    return ComputedCondensed(
        clock=Clock(
            np.asarray(times_s, np.float64),
            np.empty(0) if temperature_c is None else np.asarray(temperature_c, np.float64),
            material.delta_density_kg_m3,
            material.viscosity_pa_s,
        ),
        before=done(histograms_of_table(folder / "droplets.parquet", fine_um, times_s)),
        after=done(histograms_of_table(table, fine_um, times_s)),
        flow=flow,
        correlation=done(flow_correlation(flow_path, pixel_size_um=experiment.pixel_size_um)),
        calibration=done(
            self_calibration(
                table,
                trajectories,
                experiment.up,
                field_um=facts.field_um,
                density_over_viscosity_s_m2=material.density_over_viscosity_s_m2,
            )
        ),
        depth=_depth(facts, trajectories, flow),
        seen=in_sight(trajectories, fine_um),
        trajectories=trajectories,
        events=done(coalescences(folder / "events.parquet", pixel_size_um=experiment.pixel_size_um)),
    )


def _depth(facts: FilmFacts, trajectories: pl.DataFrame, flow: FlowMoments) -> ObservedDepth:
    rms_um_s = flow.rms_um_s[:, 0]
    known = rms_um_s[np.isfinite(rms_um_s)]
    sideways_um_s = _MEAN_OF_GAUSSIAN * float(known.mean()) if len(known) else 0.0
    return observed_depth(
        trajectories,
        statistics_edges_um(facts),
        frame_size_um=facts.extent_um,
        depth_speed_um_s=sideways_um_s,
        sideways_speed_um_s=sideways_um_s,
    )


_PARTS: dict[str, type[Any]] = {
    "clock": Clock,
    "before": FrameHistograms,
    "after": FrameHistograms,
    "flow": FlowMoments,
    "correlation": FlowCorrelation,
    "calibration": Calibration,
    "depth": ObservedDepth,
    "seen": InSight,
}
"""What stands in ``statistics.npz``; the arrays are named part.field."""


def write_condensed(found: Condensed, folder: Path, provenance: dict[str, Any]) -> None:
    """Write `FILES` into `folder`, each with its provenance inside; each appears whole or not at all."""
    about = json.dumps(provenance)
    arrays = {
        f"{part}.{field.name}": np.asarray(getattr(getattr(found, part), field.name))
        for part, kind in _PARTS.items()
        for field in fields(kind)
    }
    unfinished = folder / f"{STATISTICS_FILE}.part"
    with unfinished.open("wb") as file:
        np.savez_compressed(file, dropflow=np.array(about), **arrays)  # type: ignore[arg-type]
    unfinished.replace(folder / STATISTICS_FILE)
    for name, table in ((SUMMARY_FILE, found.trajectories), (EVENTS_FILE, found.events)):
        unfinished = folder / f"{name}.part"
        pq.write_table(table.to_arrow().replace_schema_metadata({"dropflow": about}), unfinished, compression="zstd")
        unfinished.replace(folder / name)


class StoredCondensed:
    """What `write_condensed` wrote, read part by part; `open_file` opens one of `FILES` by its name."""

    def __init__(self, open_file: Callable[[str], BinaryIO]) -> None:
        self._open = open_file

    @cached_property
    def clock(self) -> Clock:
        """Times and temperatures."""
        return self._part("clock", Clock)

    @cached_property
    def before(self) -> FrameHistograms:
        """All detections by frame and radius."""
        return self._part("before", FrameHistograms)

    @cached_property
    def after(self) -> FrameHistograms:
        """Droplets of the trajectories that were kept."""
        return self._part("after", FrameHistograms)

    @cached_property
    def flow(self) -> FlowMoments:
        """Mean and rms of the flow of each step."""
        return self._part("flow", FlowMoments)

    @cached_property
    def correlation(self) -> FlowCorrelation:
        """Correlation of the flow over distance and time."""
        return self._part("correlation", FlowCorrelation)

    @cached_property
    def calibration(self) -> Calibration:
        """Density difference over viscosity from the droplets' own velocities."""
        return self._part("calibration", Calibration)

    @cached_property
    def depth(self) -> ObservedDepth:
        """The depth in which droplets are seen."""
        return self._part("depth", ObservedDepth)

    @cached_property
    def seen(self) -> InSight:
        """How long droplets stay in sight."""
        return self._part("seen", InSight)

    @cached_property
    def trajectories(self) -> pl.DataFrame:
        """One row a trajectory."""
        return self._table(SUMMARY_FILE, STATISTICS_COLUMNS)

    @cached_property
    def events(self) -> pl.DataFrame:
        """One row a coalescence."""
        return self._table(EVENTS_FILE)

    def _part(self, part: str, kind: type[Columns]) -> Columns:
        with self._open(STATISTICS_FILE) as file, np.load(file, allow_pickle=False) as arrays:
            values = {field.name: arrays[f"{part}.{field.name}"] for field in fields(kind)}  # type: ignore[arg-type]
        return kind(**{name: value if value.ndim else value.item() for name, value in values.items()})

    def _table(self, name: str, columns: Sequence[str] | None = None) -> pl.DataFrame:
        with self._open(name) as file:
            return pl.read_parquet(file, columns=None if columns is None else list(columns))
