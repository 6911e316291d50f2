"""Which droplets the size distribution after tracking counts, with which radius, and how much each.

Counted are the droplets of trajectories that are in focus, with the radius that their whole trajectory tells and its
error, and those that were in view too briefly to make a trajectory, each as much as it is probable. Without the latter
droplets that leave soon, large ones above all, would be missing.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

COUNTED = pa.schema(
    [
        ("frame", pa.int32()),
        ("x_px", pa.float64()),
        ("y_px", pa.float64()),
        ("r_px", pa.float64()),
        ("r_um", pa.float64()),
        ("r_std_um", pa.float64()),
        ("weight", pa.float64()),
    ]
)
"""One row a droplet in a frame; `r_std_um` is 0 where the error is not known."""

_SIZED = ("r_smooth_um", "r_smooth_std_um")
_ROWS_AT_ONCE = 1 << 20
_OF_BRIEF = ("first_frame", "last_frame", "x_px", "y_px", "last_x_px", "last_y_px", "r_px", "weight")


def has_sizes(names: list[str]) -> bool:
    """Whether a table of trajectories has smoothed radii; those of older versions do not."""
    return set(_SIZED) <= set(names)


def of_trajectories(rows: pa.Table, *, out_of_focus: bool = False) -> pa.Table:
    """Rows of `COUNTED` from some of `dropflow.tables.TRAJECTORIES`; `out_of_focus` are counted as well if asked for.

    Tables without smoothed radii are counted with those of the single frames, and all their droplets as in focus.
    """
    if "is_in_focus" in rows.column_names and not out_of_focus:
        rows = rows.filter(rows["is_in_focus"])
    frame, x_px, y_px, r_px, r_um = (rows[name] for name in ("frame", "x_px", "y_px", "r_px", "r_um"))
    std_um = np.zeros(len(rows))
    if has_sizes(rows.column_names):
        smooth_um, std_um = (rows[name].to_numpy() for name in _SIZED)
        r_px, r_um = pa.array(r_px.to_numpy() * smooth_um / r_um.to_numpy()), pa.array(smooth_um)
    columns = (frame, x_px, y_px, r_px, r_um, pa.array(std_um), pa.array(np.ones(len(rows))))
    return pa.table(dict(zip(COUNTED.names, columns, strict=True)), schema=COUNTED)


def of_rejected(rows: pa.Table, *, pixel_size_um: float, out_of_focus: bool = False) -> pa.Table:
    """Rows of `COUNTED` from some of `dropflow.tracking.sizes.REJECTED`: of those in view too briefly."""
    if not {*_OF_BRIEF, "is_in_focus"} <= set(rows.column_names):
        return COUNTED.empty_table()
    brief = rows.filter(pc.greater(rows["weight"], 0.0))
    brief = brief if out_of_focus else brief.filter(brief["is_in_focus"])
    first, last, x_px, y_px, last_x_px, last_y_px, r_px, weight = (brief[name].to_numpy() for name in _OF_BRIEF)
    n_frames = (last - first + 1).astype(np.int64)
    which = np.repeat(np.arange(len(brief)), n_frames)
    after = np.arange(len(which)) - np.repeat(np.cumsum(n_frames) - n_frames, n_frames)
    share = after / np.maximum(n_frames - 1, 1)[which]
    columns = (
        first[which] + after,
        x_px[which] + share * (last_x_px - x_px)[which],
        y_px[which] + share * (last_y_px - y_px)[which],
        r_px[which],
        r_px[which] * pixel_size_um,
        np.zeros(len(which)),
        weight[which],
    )
    return pa.table(dict(zip(COUNTED.names, columns, strict=True)), schema=COUNTED)


def counted_droplets(folder: Path, *, pixel_size_um: float, out_of_focus: bool = False) -> Iterator[pa.Table]:
    """Rows of `COUNTED` of the tables in `folder`, some at a time.

    Parameters
    ----------
    folder
        Holds ``trajectories.parquet`` and ``rejected_trajectories.parquet``, without which no brief ones are counted.
    pixel_size_um
        Edge of a pixel in the sample.
    out_of_focus
        Count droplets out of focus, too.
    """
    with pq.ParquetFile(folder / "trajectories.parquet") as table:
        there = set(table.schema_arrow.names)
        wanted = ["frame", "x_px", "y_px", "r_px", "r_um"]
        wanted += [name for name in (*_SIZED, "is_in_focus") if name in there]
        for batch in table.iter_batches(_ROWS_AT_ONCE, columns=wanted):
            yield of_trajectories(pa.Table.from_batches([batch]), out_of_focus=out_of_focus)
    path = folder / "rejected_trajectories.parquet"
    if not path.is_file():
        return
    with pq.ParquetFile(path) as table:
        if not {*_OF_BRIEF, "is_in_focus"} <= set(table.schema_arrow.names):
            return
        for batch in table.iter_batches(_ROWS_AT_ONCE, columns=[*_OF_BRIEF, "is_in_focus"]):
            yield of_rejected(pa.Table.from_batches([batch]), pixel_size_um=pixel_size_um, out_of_focus=out_of_focus)
