"""Ranges of trajectory ids whose rows fit into memory easily: the table of trajectories is sorted one by one."""

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from dropflow.tracking.identification import Indices

ROWS_PER_RANGE = 1 << 18

NO_RANGES: Indices = np.empty((0, 5), np.int64)
"""One row a range: its number, first id, first frame, last frame, count of rows."""


def grown(ranges: Indices, named: pa.Table) -> Indices:
    """The ranges with the kept trajectories of one more part, which come in the order of their ids."""
    kept = named.filter(pc.equal(named["reason"], ""))
    if not len(kept):
        return ranges
    ids, first, last, n_rows = (
        kept[name].to_numpy().astype(np.int64) for name in ("trajectory_id", "first_frame", "last_frame", "n_frames")
    )
    rows_before = int(ranges[:, 4].sum()) + np.cumsum(n_rows) - n_rows
    every = np.concatenate([ranges, np.column_stack([rows_before // ROWS_PER_RANGE, ids, first, last, n_rows])])
    starts = np.flatnonzero(np.diff(every[:, 0], prepend=-1))
    return np.column_stack(
        [
            every[starts, 0],
            every[starts, 1],
            np.minimum.reduceat(every[:, 2], starts),
            np.maximum.reduceat(every[:, 3], starts),
            np.add.reduceat(every[:, 4], starts),
        ]
    )
