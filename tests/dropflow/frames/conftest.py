"""Small stacks in every form a reader knows, with the arrays that went in."""

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, BinaryIO

import av
import h5py
import numpy as np
import numpy.typing as npt
import pytest
import tifffile
import zarr
from PIL import Image

from tests.dropflow.frames.nd2_file import Nd2File

Film = npt.NDArray[Any]


@pytest.fixture
def film() -> npt.NDArray[np.uint16]:
    """Eleven frames of 12 x 17 pixels, 16 bit, all different."""
    return np.random.default_rng(1).integers(0, 65535, (11, 12, 17), dtype=np.uint16)


class MemoryFiles:
    """Named bytes."""

    def __init__(self, content: Mapping[str, bytes]) -> None:
        self._content = content

    def names(self) -> Sequence[str]:
        return list(self._content)

    def open(self, name: str) -> BinaryIO:
        return io.BytesIO(self._content[name])


def write_tiff_folder(folder: Path, film: Film) -> Path:
    """One file a frame, numbered without leading zeros."""
    folder.mkdir()
    for number, frame in enumerate(film):
        tifffile.imwrite(folder / f"frame{number}.tif", frame)
    return folder


def write_png_folder(folder: Path, film: Film) -> Path:
    """One PNG a frame, beside files that are no frames."""
    folder.mkdir()
    for number, frame in enumerate(film):
        Image.fromarray(frame).save(folder / f"frame{number}.png")
    (folder / "experiment.yaml").write_text("name: beside the frames\n")
    (folder / ".hidden.png").write_bytes(b"left by an operating system")
    return folder


def write_pages(path: Path, film: Film) -> Path:
    """One TIFF of many pages."""
    tifffile.imwrite(path, film, photometric="minisblack", compression="deflate")
    return path


def write_tiled_bigtiff(path: Path, film: Film) -> Path:
    """One BigTIFF in the other byte order, in tiles."""
    tifffile.imwrite(
        path, film, bigtiff=True, byteorder=">", tile=(16, 16), photometric="minisblack", compression="zstd"
    )
    return path


def write_ome_tiff(path: Path, film: Film) -> Path:
    """An OME-TIFF whose planes are times."""
    tifffile.imwrite(path, film, ome=True, photometric="minisblack", metadata={"axes": "TYX"})
    return path


def write_imagej(path: Path, film: Film) -> Path:
    """An ImageJ stack."""
    tifffile.imwrite(path, film, imagej=True, metadata={"axes": "TYX", "finterval": 0.5})
    return path


def write_imagej_block(path: Path, film: Film) -> Path:
    """What ImageJ writes beyond 4 GB: one page, and the frames behind it."""
    about = f"ImageJ=1.53\nimages={len(film)}\nslices={len(film)}\n"
    tifffile.imwrite(
        path, film[0].byteswap().view(film.dtype.newbyteorder(">")), description=about, metadata=None, byteorder=">"
    )
    with tifffile.TiffFile(path) as tiff:
        (start,) = tiff.pages[0].dataoffsets
    content = path.read_bytes()
    assert start + film[0].nbytes == len(content)
    path.write_bytes(content[:start] + film.astype(">u2").tobytes())
    return path


def write_metamorph(path: Path, film: Film) -> Path:
    """A MetaMorph stack: one page, tags that count the planes, and the planes behind it."""
    uic1, uic2, n = 33628, 33629, len(film)
    tags = [(uic1, 4, 2, (0, 0), True), (uic2, 5, 3 * n, (1,) * 6 * n, True)]
    tifffile.imwrite(path, film[0], metadata=None, photometric="minisblack", extratags=tags)
    with tifffile.TiffFile(path) as tiff:
        page = tiff.pages[0]
        count_at, (start,) = page.tags[uic2].offset + 4, page.dataoffsets
    content = bytearray(path.read_bytes())
    content[count_at : count_at + 4] = n.to_bytes(4, "little")
    content[start:] = film.tobytes()
    path.write_bytes(content)
    return path


def write_paged_folder(folder: Path, film: Film) -> Path:
    """Two TIFF files of several pages each."""
    folder.mkdir()
    tifffile.imwrite(folder / "part2.tif", film[4:], photometric="minisblack")
    tifffile.imwrite(folder / "part1.tif", film[:4], photometric="minisblack")
    return folder


def write_zip(path: Path, film: Film) -> Path:
    """A ZIP of TIFF files inside a folder."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, frame in enumerate(film):
            file = io.BytesIO()
            tifffile.imwrite(file, frame)
            archive.writestr(f"film/frame{number}.tif", file.getvalue())
        archive.writestr("__MACOSX/film/._frame0.tif", b"left by an operating system")
    return path


def write_zip_of_pages(path: Path, film: Film) -> Path:
    """A ZIP that holds one multi-page TIFF."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        file = io.BytesIO()
        tifffile.imwrite(file, film, photometric="minisblack")
        archive.writestr("film.tif", file.getvalue())
    return path


def encode(
    film: Film,
    *,
    container: str,
    codec: str,
    stored: str,
    given: str,
    options: dict[str, str] | None = None,
    stamps: Sequence[int] | None = None,
) -> bytes:
    """A video of `film` at 10 frames/s. `given` and `stored` are pixel formats, `stamps` the times in tenths."""
    file = io.BytesIO()
    with av.open(file, "w", format=container) as video:
        stream = video.add_stream(codec, rate=10, options=options or {})
        stream.height, stream.width, stream.pix_fmt = *film.shape[1:3], stored
        for number, pixels in enumerate(film):
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(pixels), format=given).reformat(format=stored)
            frame.pts, frame.time_base = number if stamps is None else stamps[number], Fraction(1, 10)
            for packet in stream.encode(frame):
                video.mux(packet)
        for packet in stream.encode(None):
            video.mux(packet)
    return file.getvalue()


def write_mkv(path: Path, film: Film) -> Path:
    """A lossless MKV with a key frame every four frames."""
    path.write_bytes(
        encode(film, container="matroska", codec="ffv1", stored="gray16le", given="gray16le", options={"g": "4"})
    )
    return path


def write_avi(path: Path, film: Film) -> Path:
    """A lossless AVI whose frames depend on each other, and have no stamps in this container."""
    path.write_bytes(encode(film, container="avi", codec="ffv1", stored="gray16le", given="gray16le"))
    return path


def write_quicktime(path: Path, film: Film) -> Path:
    """A QuickTime film of PNG frames."""
    path.write_bytes(encode(film, container="mov", codec="png", stored="gray16be", given="gray16le"))
    return path


def write_hdf5(path: Path, film: Film) -> Path:
    """An HDF5 file with the film beside smaller arrays."""
    with h5py.File(path, "w") as file:
        file.create_dataset("entry/frames", data=film, chunks=(4, 12, 17), compression="gzip")
        file["entry/temperature"] = np.arange(11.0)
    return path


def write_zarr(path: Path, film: Film) -> Path:
    """A Zarr array of version 3."""
    zarr.create_array(path, data=film, chunks=(4, 8, 17))
    return path


def write_zarr_2(path: Path, film: Film) -> Path:
    """A Zarr group of version 2 with the film in it."""
    group = zarr.open_group(path, mode="w", zarr_format=2)
    group.create_array("film", data=film, chunks=(1, 12, 17))
    return path


def write_ome_zarr(path: Path, film: Film) -> Path:
    """An OME-Zarr image with the axes t, c, z, y, x and a smaller copy, in shards."""
    group = zarr.open_group(path, mode="w")
    axes = [{"name": "t", "type": "time", "unit": "millisecond"}, *({"name": name} for name in "czyx")]
    scale = {"type": "scale", "scale": [500, 1, 1, 0.5, 0.5]}
    group.attrs["ome"] = {
        "version": "0.5",
        "multiscales": [
            {"axes": axes, "datasets": [{"path": str(n), "coordinateTransformations": [scale]} for n in range(2)]}
        ],
    }
    group.create_array("0", data=film[:, None, None], chunks=(1, 1, 1, 12, 17), shards=(4, 1, 1, 12, 17))
    group.create_array("1", data=film[:, None, None, ::2, ::2])
    return path


def write_zarr_zip(path: Path, film: Film) -> Path:
    """A ZIP of a Zarr folder."""
    folder = write_zarr(path.with_name("unpacked.zarr"), film)
    with zipfile.ZipFile(path, "w") as archive:
        for file in folder.rglob("*"):
            archive.write(file, Path("film.zarr") / file.relative_to(folder))
    return path


def write_nd2(path: Path, film: Film) -> Path:
    """An ND2 file."""
    return Nd2File(film[..., None], [("T", len(film))], times_ms=np.arange(len(film)) * 500.0).write(path)


def write_deflated_nd2(path: Path, film: Film) -> Path:
    """An ND2 file with lossless compression."""
    return Nd2File(film[..., None], [("T", len(film))], is_deflated=True).write(path)


WRITERS: list[Callable[[Path, Film], Path]] = [
    write_tiff_folder,
    write_png_folder,
    write_pages,
    write_tiled_bigtiff,
    write_ome_tiff,
    write_imagej,
    write_imagej_block,
    write_metamorph,
    write_paged_folder,
    write_zip,
    write_zip_of_pages,
    write_mkv,
    write_avi,
    write_quicktime,
    write_hdf5,
    write_zarr,
    write_zarr_2,
    write_ome_zarr,
    write_zarr_zip,
    write_nd2,
    write_deflated_nd2,
]
"""Every form of stack; all give back the film exactly."""
