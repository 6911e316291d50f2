"""Each way in which a stack can be wrong has its own code and names the file."""

import errno
import io
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import h5py
import numpy as np
import pytest
import tifffile
import zarr
from PIL import Image

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames import Choice, open_frames
from tests.dropflow.frames.conftest import WRITERS, MemoryFiles, write_pages, write_tiff_folder


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


def write_float(path: Path, film: np.ndarray, form: str) -> Path:
    """Frames of floating point numbers in one of the forms that hold them."""
    if form == "tiff":
        tifffile.imwrite(path, film, photometric="minisblack")
    elif form == "hdf5":
        with h5py.File(path, "w") as file:
            file["frames"] = film
    else:
        zarr.create_array(path, data=film)
    return path


@pytest.mark.parametrize("form", ["tiff", "hdf5", "zarr"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_frame_with_pixels_that_are_no_numbers_is_refused_and_counted(
    tmp_path: Path, form: str, value: float
) -> None:
    film = np.random.default_rng(2).random((3, 8, 9), dtype=np.float32)
    film[1, 2:4, 5] = value
    path = write_float(tmp_path / "film", film, form)
    with open_frames(path) as frames:
        np.testing.assert_array_equal(frames[2], film[2])
        with pytest.raises(FramesError, match="2 of 72 pixels") as raised:
            frames[1]
    assert (raised.value.code, raised.value.frame) == ("frames.not_finite", 1)


def test_half_precision_becomes_single_and_truth_becomes_black_and_white(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "half.h5", "w") as file:
        file["frames"] = np.full((2, 4, 5), 0.5, np.float16)
    with open_frames(tmp_path / "half.h5") as frames:
        assert frames.dtype == np.float32
    with h5py.File(tmp_path / "mask.h5", "w") as file:
        file["frames"] = np.eye(4, 5, dtype=bool)[None]
    with open_frames(tmp_path / "mask.h5") as frames:
        np.testing.assert_array_equal(frames[0], 255 * np.eye(4, 5))


def test_pages_in_a_circle(tmp_path: Path, film: np.ndarray) -> None:
    path = write_pages(tmp_path / "film.tif", film)
    content = bytearray(path.read_bytes())
    with tifffile.TiffFile(path) as tiff:
        first, last = tiff.pages[0].offset, tiff.pages[len(film) - 1]
        next_at = last.offset + 2 + 12 * len(last.tags)
    content[next_at : next_at + 4] = struct.pack("<I", first)
    path.write_bytes(content)
    with pytest.raises(FramesError, match="circle"):
        open_frames(path)


@pytest.mark.parametrize("compression", ["lzw", "deflate", "packbits", "lzma", "zstd"])
def test_a_strip_that_is_cut_short_inside_the_file(tmp_path: Path, film: np.ndarray, compression: str) -> None:
    path = tmp_path / "film.tif"
    tifffile.imwrite(path, film[:2], photometric="minisblack", compression=compression)
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tiff.pages[1].tags["StripByteCounts"].overwrite(100)
    with open_frames(path) as frames, pytest.raises(FramesError) as raised:
        frames[1]
    assert (raised.value.code, raised.value.frame) == ("frames.truncated", 1)


@pytest.mark.parametrize("field", ["ImageLength", "ImageWidth"])
def test_a_page_without_pixels(tmp_path: Path, film: np.ndarray, field: str) -> None:
    path = write_pages(tmp_path / "film.tif", film)
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tiff.pages[0].tags[field].overwrite(0)
    assert code_of(path) == "frames.no_pixels"


def test_pages_of_different_size_name_the_first_that_differs(tmp_path: Path, film: np.ndarray) -> None:
    path = tmp_path / "film.tif"
    with tifffile.TiffWriter(path) as writer:
        for frame in (film[0], film[1], film[2][:, :-1]):
            writer.write(frame, photometric="minisblack", metadata=None)
    with open_frames(path) as frames, pytest.raises(FramesError) as raised:
        list(frames)
    assert (raised.value.code, raised.value.frame) == ("frames.shape_mismatch", 2)


def test_an_animated_png_is_no_frame(tmp_path: Path, film: np.ndarray) -> None:
    first, *others = [Image.fromarray(frame) for frame in (film[:3] >> 8).astype(np.uint8)]
    first.save(tmp_path / "frame.png", save_all=True, append_images=others)
    assert code_of(tmp_path / "frame.png") == "frames.unreadable"


def test_a_bmp_is_read_whatever_its_depth(tmp_path: Path, film: np.ndarray) -> None:
    grey = (film[0] >> 8).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "0.bmp")
    Image.fromarray(grey > 128).save(tmp_path / "1.bmp")
    with open_frames(tmp_path) as frames:
        np.testing.assert_array_equal(frames[0], grey)
        np.testing.assert_array_equal(frames[1], np.where(grey > 128, 255, 0))


def test_a_page_that_one_file_too_many_has_is_said(tmp_path: Path, film: np.ndarray) -> None:
    folder = write_tiff_folder(tmp_path / "film", film)
    tifffile.imwrite(folder / "frame3.tif", film[:2], photometric="minisblack")
    assert code_of(folder, read=3) == "frames.page_count"


class FailingFiles(MemoryFiles):
    """Files on a disk or in a store that answers so many reads, and then fails."""

    def __init__(self, content: dict[str, bytes], n_good: int) -> None:
        super().__init__(content)
        self.n_left = n_good

    def open(self, name: str) -> BinaryIO:
        return _Failing(self, self._content[name])


class _Failing(io.BytesIO):
    def __init__(self, files: FailingFiles, content: bytes) -> None:
        super().__init__(content)
        self._files = files

    def read(self, size: int | None = -1) -> bytes:
        self._files.n_left -= 1
        if self._files.n_left < 0:
            raise OSError(errno.EIO, "the disk does not answer")
        return super().read(size)


@pytest.mark.parametrize("write", WRITERS, ids=lambda write: write.__name__.removeprefix("write_"))
def test_a_disk_that_fails_is_not_taken_for_damage(
    tmp_path: Path, film: np.ndarray, write: Callable[[Path, np.ndarray], Path]
) -> None:
    path = write(tmp_path / "stack", film)
    folder = path if path.is_dir() else path.parent
    names = [file.relative_to(folder).as_posix() for file in (path.rglob("*") if path.is_dir() else [path])]
    content = {name: (folder / name).read_bytes() for name in names if (folder / name).is_file()}
    n_good, outcomes = 0, []
    while outcomes[-1:] != ["read"]:
        try:
            with open_frames(FailingFiles(content, n_good)) as frames:
                frames.read(len(film) - 1)
            outcomes.append("read")
        except OSError as problem:
            outcomes.append(str(problem.strerror))
        n_good = n_good + 1 if n_good < 20 else int(n_good * 1.3)
    assert set(outcomes[:-1]) == {"the disk does not answer"}
    assert len(outcomes) > 2
