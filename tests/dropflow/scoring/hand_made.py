"""Small tables of truth and results, made by hand."""

from collections.abc import Iterable
from typing import Any

import pyarrow as pa

from dropflow.simulation.truth import TRUTH

PIXEL_UM = 0.5


def truth(rows: Iterable[dict[str, Any]]) -> pa.Table:
    """True droplets; what a row does not say is zero, and it is visible."""
    defaults = dict.fromkeys(TRUTH.names, 0) | {"visibility": "visible", "r_px": 10.0}
    filled = [defaults | row for row in rows]
    for row in filled:
        row |= {f"{axis}_um": row[f"{axis}_px"] * PIXEL_UM for axis in "xyr"}
    return pa.Table.from_pylist(filled, schema=TRUTH)


def results(rows: Iterable[dict[str, Any]]) -> pa.Table:
    """Results; what a row does not say is that of a droplet of 10 px."""
    defaults = {"frame": 0, "x_px": 0.0, "y_px": 0.0, "r_px": 10.0, "x_std_px": 0.1, "r_std_px": 0.5}
    filled = [defaults | {"trajectory_id": 0} | row for row in rows]
    for row in filled:
        row["r_um"] = row["r_px"] * PIXEL_UM
    whole = {"frame": pa.int32(), "trajectory_id": pa.int64()}
    names = [*defaults, "trajectory_id", "r_um"]
    return pa.Table.from_pylist(filled, schema=pa.schema([(name, whole.get(name, pa.float64())) for name in names]))


def straight_paths(n_droplets: int, n_frames: int, *, spacing_px: float = 100.0) -> list[dict[str, Any]]:
    """Droplets side by side that move down by 7 px a frame."""
    return [
        {
            "frame": frame,
            "droplet_id": i,
            "x_px": 50.0 + spacing_px * i,
            "y_px": 50.0 + 7.0 * frame,
            "r_px": 8.0 + 4 * i,
        }
        for frame in range(n_frames)
        for i in range(n_droplets)
    ]


def as_results(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of results that are what the truth says, one trajectory a droplet."""
    names = ("frame", "x_px", "y_px", "r_px")
    return [{name: row[name] for name in names} | {"trajectory_id": row["droplet_id"]} for row in rows]
