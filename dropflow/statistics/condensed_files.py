"""What a film was condensed to, as files beside its tables: written whole, read part by part as it is asked for."""

import json
from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np
import polars as pl
import pyarrow.parquet as pq

from dropflow.statistics.calibration import Calibration
from dropflow.statistics.condensed import Clock, Condensed
from dropflow.statistics.flow_correlation import FlowCorrelation
from dropflow.statistics.flow_moments import FlowMoments
from dropflow.statistics.histograms import FrameHistograms
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.lengths import ObservedDepth

Columns = TypeVar("Columns")

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
    """What `write_condensed` wrote, read part by part.

    Parameters
    ----------
    open_file
        Opens one of `FILES` by its name.
    kept
        Parts of `STATISTICS_FILE` that were read before; what is read is added. Tables are read anew.
    """

    def __init__(self, open_file: Callable[[str], BinaryIO], kept: dict[str, Any] | None = None) -> None:
        self._open, self._kept = open_file, {} if kept is None else kept

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
        """What tracking leaves of them (`dropflow.statistics.counted`)."""
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
        if part not in self._kept:
            with self._open(STATISTICS_FILE) as file, np.load(file, allow_pickle=False) as arrays:
                values = {field.name: arrays[f"{part}.{field.name}"] for field in fields(kind)}  # type: ignore[arg-type]
            for array in values.values():
                array.setflags(write=False)  # shared by all who ask
            self._kept[part] = kind(**{name: value if value.ndim else value.item() for name, value in values.items()})
        found: Columns = self._kept[part]
        return found

    def _table(self, name: str, columns: Sequence[str] | None = None) -> pl.DataFrame:
        with self._open(name) as file:
            return pl.read_parquet(file, columns=None if columns is None else list(columns))
