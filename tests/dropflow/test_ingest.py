"""Indexing a stack: order, times, checksums."""

import hashlib
import io
from pathlib import Path

import numpy as np
import pytest
import tifffile

from dropflow.errors import ExperimentError, FramesError
from dropflow.experiment import parse_experiment
from dropflow.frames import open_frames
from dropflow.ingest import check_frames, index_stack
from tests.dropflow.test_experiment import GOOD

WITH_TIMES = parse_experiment({k: v for k, v in GOOD.items() if k != "frame_interval_s"} | {"timestamps": "times.csv"})


@pytest.fixture
def stack(tmp_path: Path) -> Path:
    """Three frames in a folder."""
    for number in range(3):
        tifffile.imwrite(tmp_path / f"{number}.tif", np.full((4, 6), number, np.uint8))
    return tmp_path


def test_the_index_holds_size_times_and_checksums(stack: Path) -> None:
    index = index_stack(stack, parse_experiment(GOOD))
    assert (index.n_frames, index.shape, index.dtype, index.times_s) == (3, (4, 6), "uint8", (0.0, 1.0, 2.0))
    assert [file.name for file in index.files] == ["0.tif", "1.tif", "2.tif"]
    assert index.files[1].sha256 == hashlib.sha256((stack / "1.tif").read_bytes()).hexdigest()


def test_one_changed_pixel_or_another_flat_field_changes_the_whole_checksum(stack: Path) -> None:
    experiment = parse_experiment(GOOD)
    before = index_stack(stack, experiment).sha256
    assert index_stack(stack, experiment).sha256 == before
    assert index_stack(stack, experiment, attachments={"flat_field": io.BytesIO(b"flat")}).sha256 != before
    tifffile.imwrite(stack / "2.tif", np.full((4, 6), 9, np.uint8))
    assert index_stack(stack, experiment).sha256 != before


def test_times_come_from_the_file_that_the_experiment_names(stack: Path) -> None:
    times = io.BytesIO(b"frame,time_s\n0,0.5\n1,1.0\n2,4\n")
    assert index_stack(stack, WITH_TIMES, attachments={"timestamps": times}).times_s == (0.5, 1.0, 4.0)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"time_s\n0\n1\n", "2 times for 3 frames"),
        (b"time_s\n0\n2\n1\n", "does not increase from frame 1 to 2"),
        (b"time_s\n0\n1\nnan\n", "finite"),
        (b"time_s\n0\n1\nlate\n", "number time_s in each row"),
        (b"seconds\n0\n1\n2\n", "no column time_s"),
        (b"\xff\xfe\x00", "CSV"),
    ],
)
def test_wrong_times_name_the_field(stack: Path, content: bytes, says: str) -> None:
    with pytest.raises(ExperimentError, match=says) as raised:
        index_stack(stack, WITH_TIMES, attachments={"timestamps": io.BytesIO(content)})
    assert [problem.field for problem in raised.value.fields] == ["timestamps"]


def test_a_broken_frame_is_found_before_the_work_begins(stack: Path) -> None:
    path = stack / "2.tif"
    path.write_bytes(path.read_bytes()[:-5])
    seen = []
    with open_frames(stack) as frames, pytest.raises(FramesError) as raised:
        check_frames(frames, lambda stage, done, total: seen.append((stage, done, total)))
    assert (raised.value.frame, raised.value.file) == (2, "2.tif")
    assert seen == [("ingest", 1, 3), ("ingest", 2, 3)]
