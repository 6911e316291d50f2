"""What the way forward leaves for the way back, on disk: arrays of each step, as rows."""

import numpy as np
import pyarrow as pa

from dropflow.tracking.checkpoint import Arrays

NOTES = pa.schema([("frame", pa.int32()), ("name", pa.string()), ("values", pa.list_(pa.float64()))])
"""One row an array; `frame` is the one in which the step ends."""


def notes_to_table(notes: list[Arrays], first_frame: int) -> pa.Table:
    """The arrays of consecutive steps, each of shape (n,), float64, as rows of `NOTES`."""
    frames = np.repeat(first_frame + np.arange(len(notes), dtype=np.int32), [len(step) for step in notes])
    names = [name for step in notes for name in step]
    arrays = [array for step in notes for array in step.values()]
    ends = np.cumsum([0, *map(len, arrays)])
    values = pa.ListArray.from_arrays(ends.astype(np.int32), np.concatenate([np.empty(0), *arrays]))
    return pa.table([frames, pa.array(names, pa.string()), values], schema=NOTES)


def notes_of(table: pa.Table, frame: int) -> Arrays:
    """The arrays of one step, from rows of `NOTES` sorted by frame."""
    start, stop = np.searchsorted(table["frame"].to_numpy(), [frame, frame + 1])
    names, values = table["name"], table["values"]
    return {names[row].as_py(): values[row].values.to_numpy() for row in range(int(start), int(stop))}
