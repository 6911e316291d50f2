"""Small stacks in every form a reader knows, with the arrays that went in."""

import io
import zipfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import tifffile
from PIL import Image


@pytest.fixture
def film() -> npt.NDArray[np.uint16]:
    """Eleven frames of 12 x 17 pixels, 16 bit, all different."""
    return np.random.default_rng(1).integers(0, 65535, (11, 12, 17), dtype=np.uint16)


def write_tiff_folder(folder: Path, film: npt.NDArray[np.uint16]) -> Path:
    """One file a frame, numbered without leading zeros."""
    folder.mkdir()
    for number, frame in enumerate(film):
        tifffile.imwrite(folder / f"frame{number}.tif", frame)
    return folder


def write_png_folder(folder: Path, film: npt.NDArray[np.uint16]) -> Path:
    """One PNG a frame, beside files that are no frames."""
    folder.mkdir()
    for number, frame in enumerate(film):
        Image.fromarray(frame).save(folder / f"frame{number}.png")
    (folder / "experiment.yaml").write_text("name: beside the frames\n")
    (folder / ".hidden.png").write_bytes(b"left by an operating system")
    return folder


def write_pages(path: Path, film: npt.NDArray[np.uint16]) -> Path:
    """One TIFF of many pages."""
    tifffile.imwrite(path, film, photometric="minisblack", compression="deflate")
    return path


def write_paged_folder(folder: Path, film: npt.NDArray[np.uint16]) -> Path:
    """Two TIFF files of several pages each."""
    folder.mkdir()
    tifffile.imwrite(folder / "part2.tif", film[4:], photometric="minisblack")
    tifffile.imwrite(folder / "part1.tif", film[:4], photometric="minisblack")
    return folder


def write_zip(path: Path, film: npt.NDArray[np.uint16]) -> Path:
    """A ZIP of TIFF files inside a folder."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, frame in enumerate(film):
            file = io.BytesIO()
            tifffile.imwrite(file, frame)
            archive.writestr(f"film/frame{number}.tif", file.getvalue())
        archive.writestr("__MACOSX/film/._frame0.tif", b"left by an operating system")
    return path
