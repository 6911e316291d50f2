"""The tables of a tracked film, sorted, from parts; a range of trajectories in memory at a time."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import zarr

from dropflow.tracking.checkpoint import Spool
from dropflow.tracking.events import Surroundings, events_of_steps
from dropflow.tracking.film import FRAMES_PER_PART
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices
from dropflow.tracking.sightings import N_AVERAGED, Sightings

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


def events(
    parts: Spool, n_parts: int, flow: Path, shifts_px: Column, times_s: Column, around: Surroundings
) -> Iterator[pa.Table]:
    """Rows of `dropflow.tracking.events.EVENTS`, in the order of frames; three parts are in memory at a time."""
    if len(times_s) < 2:
        return
    velocity_um_s = zarr.open_array(flow / "velocity_um_s", mode="r")
    for part in range(n_parts):
        steps = range(part * FRAMES_PER_PART, min((part + 1) * FRAMES_PER_PART, len(times_s) - 1))
        near = [parts.read(other) for other in (part - 1, part, part + 1) if 0 <= other < n_parts]
        first, last = steps.start - N_AVERAGED, steps.stop + N_AVERAGED
        in_reach = (pc.field("frame") >= first) & (pc.field("frame") <= last)
        rows = pa.concat_tables(near).filter(in_reach)
        seen = Sightings.from_table(rows.sort_by([("trajectory_id", "ascending"), ("frame", "ascending")]))
        flows = np.asarray(velocity_um_s[steps.start : steps.stop], np.float64)
        yield events_of_steps(seen, steps, times_s, flows, shifts_px, around)


def write_table(path: Path, schema: pa.Schema, tables: Iterator[pa.Table], metadata: dict[str, str]) -> None:
    """Write tables as one Parquet file, each as its own row group; the file is there whole or not at all."""
    schema = schema.with_metadata(metadata)
    unfinished = path.with_suffix(".unfinished")
    repeating = [field.name for field in schema if not pa.types.is_floating(field.type)]
    with pq.ParquetWriter(unfinished, schema, use_dictionary=repeating) as writer:
        writer.write_table(schema.empty_table())
        for table in tables:
            if len(table):
                writer.write_table(table.replace_schema_metadata(metadata))
    unfinished.replace(path)


def in_groups(tables: Iterable[pa.Table], schema: pa.Schema) -> Iterator[pa.Table]:
    """Many small tables as few larger ones."""
    waiting = [schema.empty_table()]
    for table in tables:
        waiting.append(table)
        if sum(map(len, waiting)) >= _ROWS_PER_GROUP:
            yield pa.concat_tables(waiting)
            waiting = [schema.empty_table()]
    yield pa.concat_tables(waiting)
