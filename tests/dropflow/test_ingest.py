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
from dropflow.frames.numbering import Gap
from dropflow.ingest import StackIndex, check_frames, index_stack
from tests.dropflow.test_experiment import GOOD

TIMELESS = {field: value for field, value in GOOD.items() if field != "frame_interval_s"}
WITH_TIMES = parse_experiment(TIMELESS | {"timestamps": "times.csv"})
FROM_FRAMES = parse_experiment(TIMELESS | {"times_from_frames": True})


def write(folder: Path, *numbers: int) -> Path:
    """A frame of each number, in a folder."""
    folder.mkdir(exist_ok=True)
    for number in numbers:
        tifffile.imwrite(folder / f"run7_{number:04}.tif", np.full((4, 6), number % 256, np.uint8))
    return folder


def codes(index: StackIndex) -> list[str]:
    """Of its warnings."""
    return [warning.code for warning in index.warnings]


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
    assert seen == [("ingest", 1, 3), ("ingest", 2, 3), ("ingest", 3, 3)]


def test_all_broken_frames_are_counted_before_the_first_is_said(stack: Path) -> None:
    for name in ("1.tif", "2.tif"):
        (stack / name).write_bytes(b"no image")
    with (
        open_frames(stack) as frames,
        pytest.raises(FramesError, match=r"2 of 3 frames are broken \(also 2\)") as raised,
    ):
        check_frames(frames)
    assert (raised.value.frame, raised.value.code) == (1, "frames.not_an_image")


def test_a_given_share_of_broken_frames_may_pass_and_is_said(stack: Path) -> None:
    (stack / "1.tif").write_bytes(b"no image")
    with open_frames(stack) as frames:
        check = check_frames(frames, max_share_broken=0.4)
    assert check.broken_frames == (1,)
    assert [(w.code, w.n, w.examples) for w in check.warnings] == [("stack.frames_broken", 1, ("frame 1: 1.tif",))]
    index = index_stack(stack, parse_experiment(GOOD)).checked(check)
    assert index.broken_frames == (1,)
    assert StackIndex.model_validate_json(index.model_dump_json()) == index


def test_identical_neighbours_and_another_depth_are_noticed(stack: Path) -> None:
    tifffile.imwrite(stack / "1.tif", np.full((4, 6), 0, np.uint16))
    with open_frames(stack) as frames:
        found = {warning.code: warning for warning in check_frames(frames).warnings}
    assert found["stack.frames_identical"].examples == ("frame 1: 1.tif",)
    assert found["stack.depth_differs"].n == 1


def test_time_goes_on_over_missing_numbers_and_says_so(tmp_path: Path) -> None:
    index = index_stack(write(tmp_path / "film", 8, 9, 10, 13, 14, 16), parse_experiment(GOOD))
    assert index.times_s == (0.0, 1.0, 2.0, 5.0, 6.0, 8.0)
    assert index.gaps == (Gap(before_frame=3, n_missing=2), Gap(before_frame=5, n_missing=1))
    (warning,) = index.warnings
    assert (warning.code, warning.n) == ("stack.numbers_missing", 3)
    assert warning.examples == ("11 to 12 before run7_0013.tif", "15 to 15 before run7_0016.tif")


def test_a_corrected_interval_keeps_the_gaps(tmp_path: Path) -> None:
    index = index_stack(write(tmp_path / "film", 1, 2, 4, 5), parse_experiment(GOOD))
    assert index.timed(parse_experiment(GOOD | {"frame_interval_s": 0.5})).times_s == (0.0, 0.5, 1.5, 2.0)
    assert index.timed(WITH_TIMES) == index


def test_given_times_count_for_more_than_numbers(tmp_path: Path) -> None:
    times = io.BytesIO(b"time_s\n0\n1\n2\n")
    index = index_stack(write(tmp_path / "film", 1, 2, 5), WITH_TIMES, attachments={"timestamps": times})
    assert index.times_s == (0.0, 1.0, 2.0)
    assert codes(index) == ["stack.numbers_missing"]


def test_a_part_of_a_film_that_is_missing_is_an_error_unless_times_are_given(tmp_path: Path) -> None:
    for number in (1, 2, 4):
        tifffile.imwrite(tmp_path / f"part{number}.tif", np.zeros((2, 4, 6), np.uint8), photometric="minisblack")
    with pytest.raises(FramesError) as raised:
        index_stack(tmp_path, parse_experiment(GOOD))
    assert (raised.value.code, raised.value.file) == ("frames.part_missing", "part4.tif")
    times = io.BytesIO(b"time_s\n0\n1\n2\n3\n8\n9\n")
    assert index_stack(tmp_path, WITH_TIMES, attachments={"timestamps": times}).n_frames == 6


@pytest.fixture
def timed(tmp_path: Path) -> Path:
    """Three frames that say they were taken at 0, 0.5 and 1.0 s."""
    path = tmp_path / "film.ome.tif"
    metadata = {"axes": "TYX", "Plane": {"DeltaT": [0.0, 500.0, 1000.0], "DeltaTUnit": ["ms"] * 3}}
    tifffile.imwrite(path, np.zeros((3, 4, 6), np.uint8), ome=True, metadata=metadata)
    return path


def test_times_come_from_the_frames_own_file_if_the_experiment_says_so(timed: Path) -> None:
    index = index_stack(timed, FROM_FRAMES)
    assert index.times_s == (0.0, 0.5, 1.0)
    assert index.warnings == ()


def test_frames_without_times_name_the_field(stack: Path) -> None:
    with pytest.raises(ExperimentError, match="tells no times") as raised:
        index_stack(stack, FROM_FRAMES)
    assert [problem.field for problem in raised.value.fields] == ["times_from_frames"]


def test_an_interval_that_is_not_the_files_own_counts_and_is_said(timed: Path) -> None:
    index = index_stack(timed, parse_experiment(GOOD))
    assert index.times_s == (0.0, 1.0, 2.0)
    (warning,) = index.warnings
    assert (warning.code, warning.n) == ("stack.times_differ", 2)
    assert "0.5 s between frames" in str(warning)
    assert codes(index_stack(timed, parse_experiment(GOOD | {"frame_interval_s": 0.51}))) == []
