"""One row a trajectory, from ``trajectories.parquet``: what all statistics of single droplets start from."""

from collections.abc import Iterator
from pathlib import Path

import polars as pl
import pyarrow.parquet as pq

from dropflow.errors import ResultsError

Direction = tuple[float, float]

COLUMNS = {
    "trajectory_id": pl.Int64,
    "first_frame": pl.Int32,
    "last_frame": pl.Int32,
    "n_frames": pl.UInt32,
    "start_s": pl.Float64,
    "end_s": pl.Float64,
    "r_mean_um": pl.Float64,
    "r_std_um": pl.Float64,
    "growth_um_s": pl.Float64,
    "growth_std_um_s": pl.Float64,
    "rise_um_s": pl.Float64,
    "aside_um_s": pl.Float64,
    "sedimentation_um_s": pl.Float64,
    "x_first_um": pl.Float64,
    "y_first_um": pl.Float64,
    "r_first_um": pl.Float64,
    "x_last_um": pl.Float64,
    "y_last_um": pl.Float64,
    "r_last_um": pl.Float64,
}
"""Columns of `summarise_trajectories` and their types.

`r_std_um` is the scatter of the radius about its own straight line in time; `growth_um_s` is that line's slope.
`rise_um_s` and `aside_um_s` are the mean velocity along `up` and to its right, from the first place to the last.
`r_first_um`, `r_last_um` are means of three frames at the ends.
"""

_FRAMES_AT_ENDS = 3
_ROWS_AT_ONCE = 1 << 19
_NEEDED = ["trajectory_id", "frame", "time_s", "x_um", "y_um", "r_um", "sedimentation_um_s"]


def summarise_trajectories(rows: pl.LazyFrame, up: Direction = (0.0, -1.0)) -> pl.DataFrame:
    """Condense rows of `dropflow.tables.TRAJECTORIES`, sorted by (trajectory_id, frame), to one row a trajectory.

    Streams: memory grows with the number of trajectories, not of rows.
    """
    time, radius = pl.col("time_s"), pl.col("r_um")
    ends = pl.col("time_s").last() - pl.col("time_s").first()
    condensed = (
        rows.group_by("trajectory_id")
        .agg(
            first_frame=pl.col("frame").first(),
            last_frame=pl.col("frame").last(),
            n_frames=pl.len(),
            start_s=time.first(),
            end_s=time.last(),
            r_mean_um=radius.mean(),
            sum_tt=((time - time.first()) ** 2).sum(),
            sum_t=(time - time.first()).sum(),
            sum_tr=((time - time.first()) * (radius - radius.first())).sum(),
            sum_r=(radius - radius.first()).sum(),
            sum_rr=((radius - radius.first()) ** 2).sum(),
            dx=pl.col("x_um").last() - pl.col("x_um").first(),
            dy=pl.col("y_um").last() - pl.col("y_um").first(),
            dt=ends,
            sedimentation_um_s=pl.col("sedimentation_um_s").mean(),
            x_first_um=pl.col("x_um").first(),
            y_first_um=pl.col("y_um").first(),
            r_first_um=radius.head(_FRAMES_AT_ENDS).mean(),
            x_last_um=pl.col("x_um").last(),
            y_last_um=pl.col("y_um").last(),
            r_last_um=radius.tail(_FRAMES_AT_ENDS).mean(),
        )
        .collect(engine="streaming")
    )
    return _finished(condensed, up).sort("trajectory_id").select(*COLUMNS).cast(COLUMNS)  # type: ignore[arg-type]


def summarise_table(path: Path, up: Direction = (0.0, -1.0)) -> pl.DataFrame:
    """As `summarise_trajectories`, from the file: some row groups are in memory at a time, whatever its length.

    Raises
    ------
    ResultsError
        The file is missing, or another table.
    """
    open_trajectories(path)  # what is wrong with it
    parts = [summarise_trajectories(rows.lazy(), up) for rows in _whole_trajectories(path)]
    return pl.concat(parts) if parts else pl.DataFrame(schema=COLUMNS)


def _whole_trajectories(path: Path) -> Iterator[pl.DataFrame]:
    """Rows in batches that end with a trajectory."""
    left: pl.DataFrame | None = None
    with pq.ParquetFile(path) as table:
        for batch in table.iter_batches(_ROWS_AT_ONCE, columns=_NEEDED):
            rows = pl.DataFrame(batch)
            rows = rows if left is None else pl.concat([left, rows])
            is_last = rows["trajectory_id"] == rows["trajectory_id"][-1]
            left = rows.filter(is_last)
            if len(left) < len(rows):
                yield rows.filter(~is_last)
    if left is not None:
        yield left


def _finished(condensed: pl.DataFrame, up: Direction) -> pl.DataFrame:
    n = pl.col("n_frames").cast(pl.Float64)
    spread_t = pl.col("sum_tt") - pl.col("sum_t") ** 2 / n
    spread_tr = pl.col("sum_tr") - pl.col("sum_t") * pl.col("sum_r") / n
    spread_r = pl.col("sum_rr") - pl.col("sum_r") ** 2 / n
    slope = pl.when(spread_t > 0).then(spread_tr / spread_t)
    residual = (spread_r - slope * spread_tr).clip(lower_bound=0)
    variance = pl.when(n > 2).then(residual / (n - 2))
    moved = pl.col("dt") > 0
    return condensed.with_columns(
        growth_um_s=slope,
        growth_std_um_s=pl.when(spread_t > 0).then((variance / spread_t).sqrt()),
        r_std_um=variance.sqrt(),
        rise_um_s=pl.when(moved).then((pl.col("dx") * up[0] + pl.col("dy") * up[1]) / pl.col("dt")),
        aside_um_s=pl.when(moved).then((pl.col("dx") * -up[1] + pl.col("dy") * up[0]) / pl.col("dt")),
    )


def open_trajectories(path: Path) -> pl.LazyFrame:
    """The rows of ``trajectories.parquet``, lazily; a missing file or another table is a `ResultsError`."""
    if not path.is_file():
        raise ResultsError("There is no such table.", code="results.missing", file=str(path))
    try:
        rows = pl.scan_parquet(path)
        names = set(rows.collect_schema().names())
    except pl.exceptions.PolarsError:
        raise ResultsError("This is not a Parquet table.", file=str(path)) from None
    missing = {"trajectory_id", "frame", "r_um", "sedimentation_um_s"} - names
    if missing:
        raise ResultsError(f"The table has no column {', '.join(sorted(missing))}.", file=str(path))
    return rows
