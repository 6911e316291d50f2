"""Condensing the tables and the flow field of a film: once, streaming, into what is small enough to keep."""

from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.physics.over_time import material_over_time
from dropflow.progress import Progress, silent
from dropflow.statistics.calibration import Calibration, self_calibration
from dropflow.statistics.coalescence import coalescences
from dropflow.statistics.condensed import Clock, statistics_edges_um
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_correlation import FlowCorrelation, flow_correlation
from dropflow.statistics.flow_moments import FlowMoments, flow_moments
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.in_sight import InSight, in_sight
from dropflow.statistics.lengths import ObservedDepth, observed_depth
from dropflow.statistics.table_histograms import histograms_after_tracking, histograms_of_table
from dropflow.statistics.trajectories import summarise_table

Floats = npt.NDArray[np.float64]
Part = TypeVar("Part")

_N_STEPS = 8
_MEAN_OF_GAUSSIAN = float(np.sqrt(2 / np.pi))
"""Mean magnitude over rms."""


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
        after=done(
            histograms_after_tracking(
                folder,
                fine_um,
                times_s,
                pixel_size_um=experiment.pixel_size_um,
                out_of_focus=facts.parameters.tracking.count_out_of_focus,
            )
        ),
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
