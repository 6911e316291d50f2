"""Droplet tables on disk: written shard by shard, read back frame by frame."""

from collections.abc import Iterable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from dropflow import tables
from dropflow.droplets import Droplets
from dropflow.errors import ResultsError

_ROWS_PER_GROUP = 1 << 16


def write_droplets(path: Path, shards: Iterable[pa.Table], *, metadata: dict[str, str] | None = None) -> int:
    """Write tables of consecutive frame ranges as one Parquet file sorted by frame; return its number of rows.

    Memory holds about one row group, however long the film.
    """
    schema = tables.DROPLETS.with_metadata(metadata or {})
    n_rows, waiting = 0, tables.DROPLETS.empty_table()
    with pq.ParquetWriter(path, schema) as writer:
        for shard in shards:
            waiting = pa.concat_tables([waiting, shard])
            n_rows += len(shard)
            if len(waiting) >= _ROWS_PER_GROUP:
                writer.write_table(waiting.replace_schema_metadata(schema.metadata))
                waiting = waiting.slice(len(waiting))
        if len(waiting) or n_rows == 0:
            writer.write_table(waiting.replace_schema_metadata(schema.metadata))
    return n_rows


class DropletReader:
    """The droplets of any frame of a table written by `write_droplets`; one row group is in memory at a time."""

    def __init__(self, path: Path) -> None:
        try:
            self._file = pq.ParquetFile(path)
        except (OSError, pa.ArrowInvalid) as problem:
            raise ResultsError(f"The table of droplets cannot be read ({problem}).", file=str(path)) from None
        column = self._file.schema_arrow.get_field_index("frame")
        groups = (self._file.metadata.row_group(group) for group in range(self._file.num_row_groups))
        statistics = (group.column(column).statistics for group in groups if group.num_rows)
        self._spans = [(found.min, found.max) for found in statistics]
        self._cached: tuple[int, pa.Table] | None = None

    def __call__(self, frame: int) -> Droplets:
        """The droplets of one frame; reading in ascending or descending order is quick."""
        parts = []
        for group, (first, last) in enumerate(self._spans):
            if first <= frame <= last:
                rows = self._group(group)
                frames = rows["frame"].to_numpy()
                start, stop = frames.searchsorted([frame, frame + 1])
                parts.append(Droplets.from_table(rows.slice(start, stop - start)))
        return Droplets.concatenate(parts)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _group(self, group: int) -> pa.Table:
        if self._cached is None or self._cached[0] != group:
            self._cached = (group, self._file.read_row_group(group))
        return self._cached[1]
