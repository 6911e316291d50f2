"""The tables of a tracked film, sorted, from parts; a range of trajectories in memory at a time."""

from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from dropflow.tracking.checkpoint import Spool
from dropflow.tracking.film import FRAMES_PER_PART
from dropflow.tracking.filtering import VERDICTS
from dropflow.tracking.identification import Indices

_ROWS_PER_GROUP = 1 << 16
_NO_ID = 2**63 - 1
"""Greater than the id of any trajectory."""


def sorted_trajectories(parts: Spool, ranges: Indices, n_parts: int) -> Iterator[pa.Table]:
    """Rows sorted by (trajectory_id, frame), a table for each of `dropflow.tracking.ranges`.

    The rows of frame i stand in the part of frame i or, for the last frame of a part, in the next one.
    """
    _, first_ids, first_frames, last_frames, _ = ranges.T.tolist()
    end_ids = [*first_ids[1:], _NO_ID]
    for first_id, end_id, first, last in zip(first_ids, end_ids, first_frames, last_frames, strict=False):
        touched = range(first // FRAMES_PER_PART, min((last + 1) // FRAMES_PER_PART, n_parts - 1) + 1)
        wanted = (pc.field("trajectory_id") >= first_id) & (pc.field("trajectory_id") < end_id)
        rows = pa.concat_tables([parts.read(part).filter(wanted) for part in touched])
        yield rows.sort_by([("trajectory_id", "ascending"), ("frame", "ascending")])


def write_table(path: Path, schema: pa.Schema, tables: Iterator[pa.Table], metadata: dict[str, str]) -> None:
    """Write tables as one Parquet file, each as its own row group; the file is there whole or not at all."""
    schema = schema.with_metadata(metadata)
    unfinished = path.with_suffix(".unfinished")
    with pq.ParquetWriter(unfinished, schema) as writer:
        writer.write_table(schema.empty_table())
        for table in tables:
            if len(table):
                writer.write_table(table.replace_schema_metadata(metadata))
    unfinished.replace(path)


def rejected_trajectories(parts: Spool, n_parts: int) -> Iterator[pa.Table]:
    """The rejected trajectories, sorted by id."""
    waiting = VERDICTS.empty_table()
    for part in range(n_parts):
        waiting = pa.concat_tables([waiting, parts.read(part)])
        if len(waiting) >= _ROWS_PER_GROUP:
            yield waiting
            waiting = VERDICTS.empty_table()
    yield waiting
