"""The one contract of image stacks, kept by each form of stack."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from dropflow.errors import FramesError
from dropflow.frames import open_frames
from dropflow.frames.files import natural_order
from tests.dropflow.frames import conftest as forms

Film = npt.NDArray[np.uint16]

WRITERS = [
    forms.write_tiff_folder,
    forms.write_png_folder,
    forms.write_pages,
    forms.write_paged_folder,
    forms.write_zip,
]


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
        for index in (10, 0, 2, 1):
            np.testing.assert_array_equal(frames[index], film[index])


def test_a_frame_that_is_not_there_is_an_index_error(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames, pytest.raises(IndexError):
        frames[len(film)]


def test_each_frame_says_where_it_comes_from(stack: Path, film: Film) -> None:
    with open_frames(stack) as frames:
        labels = [frames.label(index) for index in range(len(frames))]
    assert len(set(labels)) == len(film)


def test_names_are_ordered_as_people_number_them() -> None:
    assert natural_order(["f10.tif", "f9.tif", "F1.tif", "f01b.tif"]) == ["F1.tif", "f01b.tif", "f9.tif", "f10.tif"]


def test_an_error_survives_the_way_to_another_process(tmp_path: Path) -> None:
    import pickle

    with pytest.raises(FramesError) as raised:
        open_frames(tmp_path / "nowhere")
    again = pickle.loads(pickle.dumps(raised.value))  # noqa: S301 - our own bytes
    assert (str(again), again.code, again.file) == (str(raised.value), raised.value.code, raised.value.file)
