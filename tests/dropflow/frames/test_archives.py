"""ZIP archives, hostile and good."""

import io
import stat
import struct
import tracemalloc
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from PIL import Image

from dropflow.errors import FramesError
from dropflow.frames import Choice, open_frames
from dropflow.frames import archive as archives
from tests.dropflow.frames.conftest import Film, write_zarr


def png(frame: Film) -> bytes:
    """A PNG file."""
    packed = io.BytesIO()
    Image.fromarray(frame).save(packed, "png")
    return packed.getvalue()


def refusal(path: Path, *, read: int = 0) -> FramesError:
    """The error that opening, or reading a frame, raises."""
    with pytest.raises(FramesError) as raised, open_frames(path) as frames:
        frames[read]
    return raised.value


@pytest.mark.parametrize(
    "name",
    ["../evil.png", "a/../../evil.png", "/etc/evil.png", "..\\evil.png", "C:\\evil.png", "\\\\server\\evil.png"],
)
def test_a_name_outside_the_archive_refuses_it_whole(tmp_path: Path, film: Film, name: str) -> None:
    path = tmp_path / "film.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("good.png", png(film[0]))
        archive.writestr(name, png(film[1]))
    problem = refusal(path)
    assert (problem.code, problem.file) == ("frames.unsafe_archive", "film.zip")
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_refuses_the_archive(tmp_path: Path, film: Film) -> None:
    link = zipfile.ZipInfo("frame1.png")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        archive.writestr("frame0.png", png(film[0]))
        archive.writestr(link, "/etc/passwd")
    assert refusal(tmp_path / "film.zip").code == "frames.unsafe_archive"


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_two_files_of_one_name_refuse_the_archive(tmp_path: Path, film: Film) -> None:
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        archive.writestr("frame.png", png(film[0]))
        archive.writestr("frame.png", png(film[1]))
    assert refusal(tmp_path / "film.zip").code == "frames.unsafe_archive"


def test_names_as_some_windows_programs_write_them(tmp_path: Path, film: Film) -> None:
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        for number, frame in enumerate(film):
            archive.writestr(f"film\\frame{number}.png", png(frame))
    with open_frames(tmp_path / "film.zip") as frames:
        np.testing.assert_array_equal(frames[10], film[10])


def test_a_file_with_a_password_is_said(tmp_path: Path, film: Film) -> None:
    path = tmp_path / "film.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("frame.png", png(film[0]))
    content = bytearray(path.read_bytes())
    content[6] |= 1
    content[content.rindex(b"PK\1\2") + 8] |= 1
    path.write_bytes(content)
    assert "password" in refusal(path).message


@pytest.mark.parametrize("compression", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_compressions_whose_inflating_cannot_be_bounded_are_refused(
    tmp_path: Path, film: Film, compression: int
) -> None:
    with zipfile.ZipFile(tmp_path / "film.zip", "w", compression) as archive:
        archive.writestr("frame.png", png(film[0]))
    assert refusal(tmp_path / "film.zip").code == "frames.unsupported"


def bomb(path: Path, *, said_bytes: int, name: str = "frame.png") -> Path:
    """An archive with a file that inflates to 64 MB, and says it is as large as given."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, b"\x89PNG\r\n\x1a\n" + bytes(2**26))
    content = bytearray(path.read_bytes())
    at = content.rindex(b"PK\1\2") + 24
    content[at : at + 4] = struct.pack("<I", said_bytes)
    path.write_bytes(content)
    return path


def peak_bytes(path: Path) -> int:
    """What Python took at most while the archive was refused."""
    tracemalloc.start()
    try:
        refusal(path)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_bomb_that_says_what_it_is_is_refused_unopened(tmp_path: Path) -> None:
    path = bomb(tmp_path / "film.zip", said_bytes=2**31)
    assert refusal(path).code == "frames.too_large"
    assert peak_bytes(path) < 2**22


def test_a_bomb_that_lies_is_unpacked_no_further_than_it_says(tmp_path: Path) -> None:
    path = bomb(tmp_path / "film.zip", said_bytes=1000)
    assert refusal(path).code in {"frames.truncated", "frames.not_an_image"}
    assert peak_bytes(path) < 2**22


def test_a_small_png_that_claims_to_be_huge_is_refused(tmp_path: Path) -> None:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    size = struct.pack(">IIBBBBB", 100_000, 100_000, 8, 0, 0, 0, 0)
    pixels = zlib.compress(bytes(2**20))
    content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")
    (tmp_path / "frame.png").write_bytes(content)
    assert refusal(tmp_path / "frame.png").code == "frames.too_large"


def test_a_tiff_strip_inflates_no_further_than_the_page(tmp_path: Path) -> None:
    path = tmp_path / "frame.tif"
    tifffile.imwrite(path, np.zeros((64, 64), np.uint8), compression="deflate")
    strip = zlib.compress(bytes(2**28))
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tiff.pages[0].tags["StripOffsets"].overwrite(path.stat().st_size)
        tiff.pages[0].tags["StripByteCounts"].overwrite(len(strip))
    path.write_bytes(path.read_bytes() + strip)
    tracemalloc.start()
    try:
        with pytest.raises(FramesError):
            open_frames(path)
        assert tracemalloc.get_traced_memory()[1] < 2**23
    finally:
        tracemalloc.stop()


def test_a_still_that_claims_more_than_its_bytes_can_hold_is_refused(tmp_path: Path) -> None:
    for form in ("png", "jpeg"):
        packed = io.BytesIO()
        Image.fromarray(np.zeros((64, 64), np.uint8)).save(packed, form)
        content = bytearray(packed.getvalue())
        if form == "jpeg":
            at = content.index(b"\xff\xc0") + 5
            content[at : at + 4] = struct.pack(">HH", 16000, 16000)
        else:
            content[16:24] = struct.pack(">II", 16000, 16000)
            content[29:33] = struct.pack(">I", zlib.crc32(content[12:29]))
        (tmp_path / f"frame.{form}").write_bytes(content)
        assert "too little" in refusal(tmp_path / f"frame.{form}").message


def test_a_jpeg_strip_that_claims_to_be_huge_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "frame.tif"
    tifffile.imwrite(path, np.zeros((64, 64), np.uint8), compression="jpeg", photometric="minisblack")
    content = bytearray(path.read_bytes())
    at = content.index(b"\xff\xc0")
    content[at + 5 : at + 9] = b"\xff\xf0\xff\xf0"
    path.write_bytes(content)
    assert "does not fit" in refusal(path).message


@pytest.mark.parametrize("compression", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
def test_large_files_that_are_stored_as_they_are_are_read_by_ranges(
    tmp_path: Path, film: Film, compression: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "_IN_MEMORY_BYTES", 1000)
    pages = io.BytesIO()
    tifffile.imwrite(pages, film, photometric="minisblack")
    path = tmp_path / "film.zip"
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr("notes.txt", "before")
        archive.writestr("film.tif", pages.getvalue())
        archive.writestr("more notes.txt", "after")
    with open_frames(path) as frames:
        np.testing.assert_array_equal(list(frames), film)
    path.write_bytes(path.read_bytes()[:2000])
    assert refusal(path).code == "frames.truncated"


def test_a_zarr_array_in_a_zip_of_its_own_files(tmp_path: Path, film: Film) -> None:
    folder = write_zarr(tmp_path / "film.zarr", film)
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        for file in folder.rglob("*"):
            archive.write(file, file.relative_to(folder))
    with open_frames(tmp_path / "film.zip") as frames:
        np.testing.assert_array_equal(frames[9], film[9])


@pytest.mark.parametrize(
    "content",
    [
        {"film.zip": b"PK\x05\x06" + bytes(18)},
        {"a/0.png": b"", "a/film.avi": b""},
        {"a.zarr/zarr.json": b"{}", "b.zarr/zarr.json": b"{}"},
        {"a.zarr/zarr.json": b"{}", "0.png": b""},
    ],
    ids=["zip in zip", "frames and film", "two arrays", "array and frames"],
)
def test_more_than_one_film_is_refused(tmp_path: Path, content: dict[str, Any]) -> None:
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    assert refusal(tmp_path / "film.zip").code in {"frames.several_films", "frames.empty"}


def test_a_choice_reaches_the_files_inside(tmp_path: Path, film: Film) -> None:
    with zipfile.ZipFile(tmp_path / "film.zip", "w") as archive:
        archive.writestr("frame.png", png(film[0]))
    with pytest.raises(FramesError) as raised:
        open_frames(tmp_path / "film.zip", Choice(channel=1))
    assert raised.value.code == "frames.choose"
