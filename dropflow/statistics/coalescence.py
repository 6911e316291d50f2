"""Coalescence: which droplets became one, as tracking saw it, and how often by their sizes (section 5)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.errors import ResultsError

Floats = npt.NDArray[np.float64]

EVENT_COLUMNS = {
    "frame": pl.Int32,
    "time_s": pl.Float64,
    "parent_1": pl.Int64,
    "parent_2": pl.Int64,
    "product": pl.Int64,
    "x_um": pl.Float64,
    "y_um": pl.Float64,
    "r_1_um": pl.Float64,
    "r_2_um": pl.Float64,
    "r_product_um": pl.Float64,
    "volume_residual": pl.Float64,
}
"""One row an event. `parent_1` is the larger one; `product` is `parent_1` where that trajectory goes on.

`volume_residual` is the product's volume minus the parents', in its own standard deviations.
"""


def coalescences(path: Path, *, pixel_size_um: float) -> pl.DataFrame:
    """The coalescences among the events that tracking saw, one row each, sorted by frame.

    Parameters
    ----------
    path
        ``events.parquet``.
    pixel_size_um
        Edge of a pixel in the sample.

    Raises
    ------
    ResultsError
        The file is missing, as in results of a version that did not write it.
    """
    if not path.is_file():
        raise ResultsError(
            "A part of the results is missing.",
            code="results.missing",
            file=str(path),
            hint="Analyse the film again with this version.",
        )
    return (
        pl.scan_parquet(path)
        .filter(pl.col("kind") == "coalescence")
        .select(
            "frame",
            "time_s",
            "r_1_um",
            "r_2_um",
            "volume_residual",
            parent_1="trajectory_id",
            parent_2="other_id",
            product="product_id",
            x_um=pl.col("x_px") * pixel_size_um,
            y_um=pl.col("y_px") * pixel_size_um,
            r_product_um="r_um",
        )
        .select(*EVENT_COLUMNS)
        .cast(EVENT_COLUMNS)  # type: ignore[arg-type]
        .collect()
    )


@dataclass(frozen=True)
class CoalescenceRates:
    """Events by the radii of both partners."""

    edges_um: Floats
    """Shape (n + 1,)."""
    counts: npt.NDArray[np.int64]
    """Shape (n, n): smaller partner along the first axis, larger along the second."""
    rate_per_um2_s: Floats
    """Events per area of the frame and time, shape (n, n); its relative error is 1 / sqrt(counts)."""


def coalescence_rates(
    events: pl.DataFrame, edges_um: Floats, *, area_um2: float, duration_s: float
) -> CoalescenceRates:
    """Count events by size pair, per area and time."""
    r = np.sort(np.stack([events["r_1_um"].to_numpy(), events["r_2_um"].to_numpy()]), axis=0)
    counts, _, _ = np.histogram2d(r[0], r[1], bins=(edges_um, edges_um))
    rate = counts / (area_um2 * duration_s) if duration_s > 0 else np.zeros_like(counts)
    return CoalescenceRates(edges_um, counts.astype(np.int64), rate)
