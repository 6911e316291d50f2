"""Damages small good files by seeds and reads them, in a process of its own with little memory.

    python -m tests.dropflow.frames.fuzzing KIND FIRST_SEED N

Writes the seed it is at to standard output before it tries it, so that whoever started it knows which one ended it.
Ends with a line ``done {...}``: how often each outcome came, and the peak of memory.
"""

import io
import json
import random
import resource
import signal
import sys
import tempfile
import zipfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import tifffile
from PIL import Image

from dropflow.errors import FramesError
from dropflow.frames import Choice, open_frames
from tests.dropflow.frames import conftest as forms

MEMORY_BYTES = 3 * 2**30
"""Of addresses; what a good small file takes is mostly the libraries themselves."""
SECONDS_A_FILE = 20
_MAX_FRAMES_READ = 12
_BOUNDARIES = [b"\0", b"\1", b"\x7f", b"\x80", b"\xff"]

Content = dict[str, bytes]


def film() -> np.ndarray:
    """Six small frames."""
    return np.random.default_rng(1).integers(0, 65535, (6, 24, 32), dtype=np.uint16)


def _files(write: Callable[[Path, np.ndarray], Path]) -> Content:
    with tempfile.TemporaryDirectory() as folder:
        path = write(Path(folder) / "film", film())
        if path.is_file():
            return {path.name: path.read_bytes()}
        return {p.relative_to(path).as_posix(): p.read_bytes() for p in sorted(path.rglob("*")) if p.is_file()}


def _still(suffix: str) -> Content:
    packed = io.BytesIO()
    Image.fromarray((film()[0] >> 8).astype(np.uint8)).save(packed, suffix)
    return {f"frame.{suffix}": packed.getvalue()}


def _tiff(**options: object) -> Content:
    packed = io.BytesIO()
    tifffile.imwrite(packed, film(), photometric="minisblack", **options)
    return {"film.tif": packed.getvalue()}


def _jpeg_tiff() -> Content:
    packed = io.BytesIO()
    tifffile.imwrite(packed, (film() >> 8).astype(np.uint8), photometric="minisblack", compression="jpeg")
    return {"film.tif": packed.getvalue()}


def _video(container: str, codec: str, stored: str, given: str = "gray16le") -> Content:
    pixels = film() if given == "gray16le" else (film() >> 8).astype(np.uint8)
    options = {"x264-params": "log-level=none"} if codec == "libx264" else {}
    content = forms.encode(pixels, container=container, codec=codec, stored=stored, given=given, options=options)
    return {"film": content}


def _zip_of_stills() -> Content:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, frame in enumerate(film()):
            still = io.BytesIO()
            tifffile.imwrite(still, frame)
            archive.writestr(f"frame{number}.tif", still.getvalue())
    return {"film.zip": packed.getvalue()}


KINDS: dict[str, Callable[[], Content]] = {
    "tiff": _tiff,
    "tiff_deflate": lambda: _tiff(compression="deflate", predictor=True),
    "tiff_lzw_tiles": lambda: _tiff(compression="lzw", tile=(16, 16), bigtiff=True),
    "tiff_zstd": lambda: _tiff(compression="zstd", rowsperstrip=5),
    "tiff_jpeg": _jpeg_tiff,
    "ome_tiff": lambda: _files(forms.write_ome_tiff),
    "imagej": lambda: _files(forms.write_imagej_block),
    "png": lambda: _still("png"),
    "jpeg": lambda: _still("jpeg"),
    "bmp": lambda: _still("bmp"),
    "zip": _zip_of_stills,
    "avi_raw": lambda: _video("avi", "rawvideo", "gray", "gray"),
    "avi_mjpeg": lambda: _video("avi", "mjpeg", "yuvj420p", "gray"),
    "avi_ffv1": lambda: _video("avi", "ffv1", "gray16le"),
    "mp4": lambda: _video("mp4", "libx264", "yuv420p", "gray"),
    "mkv": lambda: _video("matroska", "ffv1", "gray16le"),
    "hdf5": lambda: _files(forms.write_hdf5),
    "zarr": lambda: _files(forms.write_zarr),
    "zarr_2": lambda: _files(forms.write_zarr_2),
    "ome_zarr": lambda: _files(forms.write_ome_zarr),
    "nd2": lambda: _files(forms.write_nd2),
    "nd2_deflate": lambda: _files(forms.write_deflated_nd2),
}
"""A good stack of each kind."""

SHORT_KINDS = ["tiff_deflate", "ome_tiff", "png", "jpeg", "bmp", "zip", "avi_raw", "mp4", "mkv", "hdf5", "zarr", "nd2"]
"""One of each reader."""


def damaged(content: Content, seed: int) -> Content:
    """One of the files with a few bytes changed, removed, doubled or cut off; mostly where the structure is."""
    chance = random.Random(seed)
    name = chance.choice(sorted(content))
    data = bytearray(content[name])
    for _ in range(chance.choice([1, 1, 1, 2, 4, 16])):
        ends = min(len(data), 600)
        at = chance.choice(
            [chance.randrange(ends), len(data) - 1 - chance.randrange(ends), chance.randrange(len(data))]
        )
        n = chance.choice([1, 2, 4, 8])
        match chance.randrange(6):
            case 0 | 1:
                data[at : at + n] = chance.choice(_BOUNDARIES) * n
            case 2:
                data[at] ^= 1 << chance.randrange(8)
            case 3:
                del data[at : at + chance.randrange(1, 64)]
            case 4:
                data[at:at] = data[at : at + chance.randrange(1, 64)]
            case _ if chance.random() < 0.3:
                del data[at:]
        if not data:
            data = bytearray(b"\0")
    return content | {name: bytes(data)}


def outcome(content: Content) -> str:
    """Read the first frames: their errors' codes, or ``frames``. Anything that is neither is raised."""
    try:
        with open_frames(forms.MemoryFiles(content), Choice(grey_from="luminance")) as frames:
            frames.times_s()
            frames.findings()
            for index in range(min(len(frames), _MAX_FRAMES_READ)):
                frame = frames.read(index)
                assert frame.shape == frames.shape
                assert frame.dtype.kind in "uif"
                assert frame.dtype.kind != "f" or np.isfinite(frame).all()
        return "frames"
    except FramesError as problem:
        said = problem
    assert said.code.startswith("frames.")
    assert said.file
    assert "\n" not in str(said)
    return said.code


def main(kind: str, first_seed: int, n: int) -> None:
    """Try `n` seeds."""
    good = KINDS[kind]()
    assert outcome(good) == "frames", "the undamaged file must be read"
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    outcomes: Counter[str] = Counter()
    for seed in range(first_seed, first_seed + n):
        sys.stdout.write(f"{seed}\n")
        sys.stdout.flush()
        signal.alarm(SECONDS_A_FILE)
        outcomes[outcome(damaged(good, seed))] += 1
    signal.alarm(0)
    grown_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb) / 1024
    sys.stdout.write("done " + json.dumps({"outcomes": outcomes, "grown_mb": round(grown_mb)}) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
