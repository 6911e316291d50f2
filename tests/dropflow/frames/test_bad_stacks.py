"""Each way in which a stack can be wrong has its own code and names the file."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames import Choice, open_frames
from tests.dropflow.frames.conftest import write_pages, write_tiff_folder


def code_of(path: Path, *, read: int | None = None) -> str:
    """The code of the error that opening (and reading one frame) raises; each must also say something in one line."""
    with pytest.raises(FramesError) as raised, open_frames(path) as frames:
        frames[0 if read is None else read]
    assert "\n" not in str(raised.value)
    return raised.value.code


def test_a_missing_folder(tmp_path: Path) -> None:
    assert code_of(tmp_path / "nowhere") == "frames.not_found"


def test_an_empty_folder(tmp_path: Path) -> None:
    assert code_of(tmp_path) == "frames.empty"


def test_a_text_file_called_tif(tmp_path: Path) -> None:
    (tmp_path / "frame.tif").write_text("not an image")
    assert code_of(tmp_path) == "frames.not_an_image"
    assert code_of(tmp_path / "frame.tif") == "frames.not_an_image"


def test_an_empty_file(tmp_path: Path) -> None:
    (tmp_path / "frame.tif").touch()
    assert code_of(tmp_path) == "frames.not_an_image"


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.98])
def test_a_tiff_cut_anywhere(tmp_path: Path, film: np.ndarray, share: float) -> None:
    path = write_pages(tmp_path / "film.tif", film)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    assert code_of(path, read=len(film) - 1) in {"frames.truncated", "frames.empty"}


def test_a_png_cut_in_the_middle_names_the_frame(tmp_path: Path, film: np.ndarray) -> None:
    for number in range(3):
        Image.fromarray(film[number]).save(tmp_path / f"{number}.png")
    path = tmp_path / "1.png"
    path.write_bytes(path.read_bytes()[:-200])
    with open_frames(tmp_path) as frames, pytest.raises(FramesError) as raised:
        frames[1]
    assert (raised.value.code, raised.value.file, raised.value.frame) == ("frames.truncated", "1.png", 1)


def test_frames_of_different_size_name_the_first_that_differs(tmp_path: Path, film: np.ndarray) -> None:
    folder = write_tiff_folder(tmp_path / "film", film)
    tifffile.imwrite(folder / "frame3.tif", film[3][:, :-1])
    with open_frames(folder) as frames, pytest.raises(FramesError) as raised:
        frames[3]
    assert (raised.value.code, raised.value.file, raised.value.frame) == ("frames.shape_mismatch", "frame3.tif", 3)


@pytest.mark.parametrize("suffix", ["png", "tif", "jpg", "bmp"])
def test_colour_is_refused_until_the_experiment_says_how_it_becomes_grey(tmp_path: Path, suffix: str) -> None:
    colour = np.zeros((16, 16, 3), np.uint8)
    colour[..., 1] = 200
    path = tmp_path / f"frame.{suffix}"
    Image.fromarray(colour).save(path)
    assert code_of(path) == "frames.colour"
    with open_frames(path, Choice(grey_from=GreyFrom.GREEN)) as frames:
        assert frames[0].shape == (16, 16)
        assert frames[0].mean() == pytest.approx(200, abs=1)
    with open_frames(path, Choice(grey_from=GreyFrom.LUMINANCE)) as frames:
        assert frames[0].mean() == pytest.approx(0.587 * 200, abs=1.5)


def test_a_tiff_that_claims_to_be_huge_is_refused_without_taking_memory(tmp_path: Path) -> None:
    path = tmp_path / "huge.tif"
    tifffile.imwrite(path, np.zeros((8, 8), np.uint8))
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tiff.pages[0].tags["ImageLength"].overwrite(2**31)
        tiff.pages[0].tags["ImageWidth"].overwrite(2**31)
    assert code_of(path) in {"frames.too_large", "frames.truncated"}


def test_a_zip_without_images_and_a_broken_zip(tmp_path: Path) -> None:
    path = tmp_path / "film.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("notes.txt", "no frames here")
    assert code_of(path) == "frames.empty"
    path.write_bytes(path.read_bytes()[:-20])
    assert code_of(path) == "frames.truncated"


def test_frames_in_two_folders_of_a_zip_are_not_mixed(tmp_path: Path) -> None:
    path = tmp_path / "film.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("flat/flat.png", b"")
        archive.writestr("frames/0.png", b"")
    assert code_of(path) == "frames.several_folders"


def test_complex_pixels_are_no_intensities(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "frame.tif", np.zeros((8, 8), np.complex64))
    assert code_of(tmp_path / "frame.tif") == "frames.not_intensities"
