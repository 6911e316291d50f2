"""Tables of droplets: written by shard, read by frame."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dropflow import detections, tables
from dropflow.droplets import Droplets


def droplets_of(frame: int, n: int) -> Droplets:
    """Droplets whose x tells their frame."""
    return Droplets(*(np.full(n, frame + column / 10) for column in range(7)))


@settings(max_examples=25, deadline=None)
@given(counts=st.lists(st.integers(0, 30), min_size=1, max_size=12), rows_per_group=st.integers(1, 40))
def test_every_frame_gives_back_its_own_droplets(
    tmp_path_factory: pytest.TempPathFactory, counts: list[int], rows_per_group: int
) -> None:
    path = tmp_path_factory.mktemp("table") / "droplets.parquet"
    shards = (
        droplets_of(frame, n).to_table(frame=frame, time_s=0.5 * frame, pixel_size_um=2.0)
        for frame, n in enumerate(counts)
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(detections, "_ROWS_PER_GROUP", rows_per_group)
        assert detections.write_droplets(path, shards, metadata={"dropflow": "{}"}) == sum(counts)
    reader = detections.DropletReader(path)
    for frame, n in reversed(list(enumerate(counts))):
        found = reader(frame)
        assert len(found) == n
        assert (found.x_px == frame).all()
    assert len(reader(len(counts))) == 0
    reader.close()


def test_the_table_has_the_promised_columns_in_micrometres_too(tmp_path: Path) -> None:
    path = tmp_path / "droplets.parquet"
    detections.write_droplets(path, [droplets_of(3, 2).to_table(frame=3, time_s=1.5, pixel_size_um=0.625)])
    table = pq.read_table(path)
    assert table.schema.equals(tables.DROPLETS)
    assert table["x_um"].to_pylist() == [3 * 0.625] * 2
    assert table["r_um"].to_pylist() == [3.2 * 0.625] * 2
    assert table["time_s"].to_pylist() == [1.5] * 2
