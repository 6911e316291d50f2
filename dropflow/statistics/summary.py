"""The numbers of ``summary.json``: what came of a run, at a glance."""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow.parquet as pq
import zarr

from dropflow.experiment import Experiment, FixedMaterial
from dropflow.ingest import StackIndex
from dropflow.statistics.counted import counted_droplets
from dropflow.statistics.findings import Findings

_STEPS_AT_ONCE = 256


def summarise(
    folder: Path,
    index: StackIndex,
    experiment: Experiment,
    material: FixedMaterial,
    *,
    out_of_focus: bool = False,
) -> dict[str, Any]:
    """Counts, radii and the flow of a finished run; units are in the names, None where there is no value.

    Parameters
    ----------
    folder
        Holds ``droplets.parquet``, ``trajectories.parquet``, ``rejected_trajectories.parquet`` and ``flow.zarr``.
    index, experiment
        What was analysed.
    material
        Mean over the frames.
    out_of_focus
        Whether droplets out of focus count in the radii after tracking.
    """
    tracked = pq.ParquetFile(folder / "trajectories.parquet")
    n_frames_of = _n_frames_of_trajectories(tracked)
    height_um, width_um = (side * experiment.pixel_size_um for side in index.shape)
    return {
        "n_frames": index.n_frames,
        "duration_s": index.times_s[-1] - index.times_s[0],
        "field_of_view_um": [width_um, height_um],
        "delta_density_kg_m3": material.delta_density_kg_m3,
        "viscosity_pa_s": material.viscosity_pa_s,
        "temperature_c": [min(index.temperatures_c), max(index.temperatures_c)] if index.temperatures_c else None,
        "detected": _detected(pq.ParquetFile(folder / "droplets.parquet"), index.n_frames),
        "tracked": _tracked(folder, tracked, index.n_frames, experiment.pixel_size_um, out_of_focus=out_of_focus),
        "n_trajectories": len(n_frames_of),
        "mean_trajectory_frames": float(n_frames_of.mean()) if len(n_frames_of) else None,
        "n_rejected_trajectories": _rejected(folder / "rejected_trajectories.parquet"),
        "flow": _flow(folder / "flow.zarr"),
    }


def statistics_of(found: Findings) -> dict[str, Any]:
    """What the statistics say, each with its standard error; None where there is no value."""
    calibration, correlation, depth = found.calibration, found.correlation, found.depth
    period_s = found.oscillations.period_s
    driving = found.driving
    values: dict[str, float] = {
        "density_over_viscosity_s_m2": calibration.density_over_viscosity_s_m2,
        "density_over_viscosity_std_s_m2": calibration.std_s_m2,
        "density_over_viscosity_of_material_s_m2": calibration.expected_s_m2,
        "relative_radius_scatter": found.scatter.relative,
        "relative_radius_scatter_std": found.scatter.relative_std,
        "correlation_length_um": correlation.length_um,
        "correlation_length_std_um": correlation.length_std_um,
        "correlation_time_s": correlation.time_s,
        "correlation_time_std_s": correlation.time_std_s,
        "depth_per_radius": depth.per_radius,
        "depth_per_radius_std": depth.per_radius_std,
        "mean_period_s": float(period_s.mean()) if len(period_s) else math.nan,
        "driving_per_s": math.nan if driving is None else driving.mean_per_s,
        "driving_std_per_s": math.nan if driving is None else driving.mean_std_per_s,
    }
    return {
        **{name: value if math.isfinite(value) else None for name, value in values.items()},
        "n_oscillations": len(found.oscillations.peak_s),
        "n_uncertain_oscillations": int((~found.oscillations.is_certain).sum()),
        "n_coalescences": len(found.events),
        "periods": _periods(found),
    }


def _periods(found: Findings) -> list[dict[str, float | bool]]:
    of = found.oscillations
    columns = (of.period_at_s, of.period_s, of.period_std_s, of.is_period_certain)
    return [
        {"at_s": float(at), "period_s": float(period), "period_std_s": float(std), "is_certain": bool(certain)}
        for at, period, std, certain in zip(*columns, strict=True)
    ]


def _detected(table: pq.ParquetFile, n_frames: int) -> dict[str, float | int | None]:
    """Numbers and radii of all detections."""
    sums = np.zeros(4)
    for batch in table.iter_batches(columns=["r_um"]):
        radius_um = batch["r_um"].to_numpy()
        sums += [np.sum(radius_um**power) for power in range(4)]
    return _numbers(table, n_frames) | _radii(sums)


def _tracked(
    folder: Path, table: pq.ParquetFile, n_frames: int, pixel_size_um: float, *, out_of_focus: bool
) -> dict[str, float | int | None]:
    """Numbers of droplets in trajectories, and radii of those that the size distribution counts."""
    sums = np.zeros(4)
    for rows in counted_droplets(folder, pixel_size_um=pixel_size_um, out_of_focus=out_of_focus):
        radius_um, weight = rows["r_um"].to_numpy(), rows["weight"].to_numpy()
        sums += [np.sum(weight * radius_um**power) for power in range(4)]
    return {
        **_numbers(table, n_frames),
        **_radii(sums),
        "found_by_prediction_share": _share_without(table, "is_detected"),
        "out_of_focus_share": _share_without(table, "is_in_focus"),
        "n_counted": float(sums[0]),
    }


def _numbers(table: pq.ParquetFile, n_frames: int) -> dict[str, float | int | None]:
    n = table.metadata.num_rows
    return {"n_droplets": n, "n_droplets_per_frame": n / n_frames}


def _radii(sums: npt.NDArray[np.float64]) -> dict[str, float | int | None]:
    """From sums of r^0 to r^3; d32 = sum d^3 / sum d^2 is the Sauter diameter."""
    n, first, second, third = sums
    return {
        "mean_radius_um": float(first / n) if n else None,
        "radius_std_um": math.sqrt(max(second / n - (first / n) ** 2, 0.0)) if n else None,
        "sauter_radius_um": float(third / second) if n else None,
    }


def _n_frames_of_trajectories(table: pq.ParquetFile) -> npt.NDArray[np.int64]:
    """Rows of each trajectory; ids are sorted, and one may go on in the next batch."""
    counts: Counter[int] = Counter()
    for batch in table.iter_batches(columns=["trajectory_id"]):
        ids, rows = np.unique(batch["trajectory_id"].to_numpy(), return_counts=True)
        counts.update(dict(zip(ids.tolist(), rows.tolist(), strict=True)))
    return np.fromiter(counts.values(), np.int64, len(counts))


def _share_without(table: pq.ParquetFile, flag: str) -> float | None:
    """Rows in which the flag is not set, over all; None where there are none, or no such column."""
    if not table.metadata.num_rows or flag not in table.schema_arrow.names:
        return None
    n_without = sum(int(batch[flag].false_count) for batch in table.iter_batches(columns=[flag]))
    return n_without / int(table.metadata.num_rows)


def _rejected(path: Path) -> dict[str, int]:
    counts = Counter(pq.read_table(path, columns=["reason"])["reason"].to_pylist())
    return dict(sorted(counts.items()))


def _flow(path: Path) -> dict[str, float | None]:
    """Mean and rms of the flow over all cells that were computed from droplets (section 4.6)."""
    velocities, interpolated = (zarr.open_array(path / name, mode="r") for name in ("velocity_um_s", "is_interpolated"))
    sums, n = np.zeros((2, 2)), 0
    n_steps = velocities.shape[0]
    for start in range(0, n_steps, _STEPS_AT_ONCE):
        steps = slice(start, start + _STEPS_AT_ONCE)
        is_computed = ~np.asarray(interpolated[steps])
        velocity = np.moveaxis(np.asarray(velocities[steps], np.float64), 1, -1)[is_computed]
        sums += [velocity.sum(axis=0), (velocity**2).sum(axis=0)]
        n += len(velocity)
    names = ("mean_u_um_s", "mean_v_um_s", "rms_u_um_s", "rms_v_um_s")
    values = [*sums[0] / n, *np.sqrt(sums[1] / n)] if n else [None] * 4
    cells = n_steps * int(np.prod(velocities.shape[2:]))
    found = {name: None if value is None else float(value) for name, value in zip(names, values, strict=True)}
    return found | {"computed_share": n / cells if cells else None}
