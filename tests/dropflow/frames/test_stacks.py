"""The one contract of image stacks, kept by each form of stack."""

import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from dropflow.errors import FramesError
from dropflow.frames import open_frames
from dropflow.frames.files import FolderFiles, natural_order
from tests.dropflow.frames.conftest import WRITERS, MemoryFiles

Film = npt.NDArray[np.uint16]


@pytest.fixture(params=WRITERS, ids=lambda writer: writer.__name__.removeprefix("write_"))
def stack(request: pytest.FixtureRequest, tmp_path: Path, film: Film) -> Path:
    """The film in one of the forms."""
    write: Callable[[Path, Film], Path] = request.param
    return write(tmp_path / "stack", film)


def test_frames_come_back_as_written_in_natural_order(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        assert len(frames) == len(film)
        assert frames.shape == film.shape[1:]
        assert frames.dtype == film.dtype
        for index in (10, 0, 2, 1, 1, 6, 7, 3):
            np.testing.assert_array_equal(frames[index], film[index], err_msg=f"frame {index}")
        np.testing.assert_array_equal(list(frames), film)


def test_named_files_from_elsewhere_are_the_same_stack(stack: Path, film: Film) -> None:
    folder = stack if stack.is_dir() else stack.parent
    names = FolderFiles(folder, is_deep=True).names() if stack.is_dir() else [stack.name]
    files = MemoryFiles({f"dropped/{name}": (folder / name).read_bytes() for name in names})
    with open_frames(files) as frames:
        np.testing.assert_array_equal(frames[7], film[7])
        np.testing.assert_array_equal(frames[0], film[0])


def test_frames_are_the_machines_own_numbers_and_nobody_elses(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        frame = frames[3]
        assert frame.dtype.isnative
        assert frame.flags.c_contiguous
        np.testing.assert_array_equal(frames[3], film[3])


def test_a_frame_that_is_not_there_is_an_index_error(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        for index in (len(film), -1):
            with pytest.raises(IndexError):
                frames[index]


def test_each_frame_says_where_it_comes_from(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        labels = [frames.label(index) for index in range(len(frames))]
    assert len(set(labels)) == len(film)


def test_several_threads_may_read_one_stack(stack: Path, film: Film) -> None:
    wrong = []

    def read(start: int) -> None:
        wrong.extend(i for i in range(start, len(film), 2) if not np.array_equal(frames[i], film[i]))

    with open_frames(stack) as frames:
        threads = [threading.Thread(target=read, args=(start,)) for start in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert wrong == []


def test_times_are_one_a_frame_or_unknown(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        times_s = frames.times_s()
    assert times_s is None or (times_s.shape == (len(film),) and times_s.dtype == np.float64)


def test_a_good_stack_gives_no_findings(stack: Path) -> None:
    with open_frames(stack) as frames:
        assert frames.findings() == ()


def test_names_are_ordered_as_people_number_them() -> None:
    assert natural_order(["f10.tif", "f9.tif", "F1.tif", "f01b.tif"]) == ["F1.tif", "f01b.tif", "f9.tif", "f10.tif"]


def test_an_error_survives_the_way_to_another_process(tmp_path: Path) -> None:
    import pickle

    with pytest.raises(FramesError) as raised:
        open_frames(tmp_path / "nowhere")
    again = pickle.loads(pickle.dumps(raised.value))  # noqa: S301 - our own bytes
    assert (str(again), again.code, again.file) == (str(raised.value), raised.value.code, raised.value.file)
