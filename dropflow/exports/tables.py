"""Trajectories as CSV, Parquet, trackpy's and napari's tables: row by row, whatever their number."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from dropflow.results import Results

_ROWS_AT_ONCE = 1 << 17


def write_csv(results: Results, output: Path) -> None:
    """All columns of the trajectories; the provenance stands in the first line, after ``# dropflow: ``."""
    _write_csv(results, output, lambda rows: rows)


def write_trackpy(results: Results, output: Path) -> None:
    """The columns that trackpy and its users expect, and those of ours that it lets pass.

    `x`, `y` in px; `size` is the radius in px as in trackpy (there the radius of gyration); `mass` is the match.
    """

    def columns(rows: pa.Table) -> pa.Table:
        names = {
            "frame": "frame",
            "particle": "trajectory_id",
            "x": "x_px",
            "y": "y_px",
            "size": "r_px",
            "mass": "match",
        }
        more = ("time_s", "r_um", "u_um_s", "v_um_s", "is_detected")
        return pa.table({new: rows[old] for new, old in names.items()} | {name: rows[name] for name in more})

    _write_csv(results, output, columns)


def write_napari(results: Results, output: Path) -> None:
    """The rows of napari's tracks layer (track_id, t, y, x in px), sorted by track and time, with more columns."""

    def columns(rows: pa.Table) -> pa.Table:
        names = {"track_id": "trajectory_id", "t": "frame", "y": "y_px", "x": "x_px"}
        more = ("r_px", "u_um_s", "v_um_s")
        return pa.table({new: rows[old] for new, old in names.items()} | {name: rows[name] for name in more})

    _write_csv(results, output, columns)


def write_parquet(results: Results, output: Path) -> None:
    """The trajectories with the provenance under ``dropflow`` in the metadata."""
    with pq.ParquetFile(results.trajectories) as table:
        schema = table.schema_arrow.with_metadata({"dropflow": json.dumps(results.provenance)})
        with pq.ParquetWriter(output, schema, compression="zstd") as writer:
            for rows in trajectory_rows(table):
                writer.write_table(rows.cast(schema))


def trajectory_rows(table: pq.ParquetFile) -> Iterator[pa.Table]:
    """The rows in batches, in order."""
    for batch in table.iter_batches(_ROWS_AT_ONCE):
        yield pa.Table.from_batches([batch])


def _write_csv(results: Results, output: Path, columns: Callable[[pa.Table], pa.Table]) -> None:
    with pq.ParquetFile(results.trajectories) as table, output.open("wb") as file:
        file.write(f"# dropflow: {json.dumps(results.provenance)}\n".encode())
        schema = columns(table.schema_arrow.empty_table()).schema
        with pa_csv.CSVWriter(file, schema) as writer:
            for rows in trajectory_rows(table):
                writer.write_table(columns(rows))
