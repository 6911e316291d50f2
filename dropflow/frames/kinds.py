"""What a file is, by its first bytes and never by its name."""

from typing import BinaryIO

from dropflow.errors import FramesError

STILLS = frozenset({"png", "jpeg", "bmp"})
"""Files of exactly one image. A TIFF may be one, too."""
VIDEOS = frozenset({"avi", "mp4", "mkv"})
KINDS = STILLS | VIDEOS | {"tiff", "zip", "hdf5", "nd2"}

HEAD_BYTES = 520
"""How many first bytes `kind_of` wants to see: MATLAB puts 512 of its own before an HDF5 file."""

_MAGIC = {
    b"II*\0": "tiff",
    b"MM\0*": "tiff",
    b"II+\0": "tiff",
    b"MM\0+": "tiff",
    b"\x89PNG\r\n\x1a\n": "png",
    b"\xff\xd8\xff": "jpeg",
    b"PK\x03\x04": "zip",
    b"PK\x05\x06": "zip",
    b"\x1a\x45\xdf\xa3": "mkv",
    b"\xda\xce\xbe\x0a": "nd2",
}
_HDF5 = b"\x89HDF\r\n\x1a\n"
_QUICKTIME_BOXES = {b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip"}
_BMP_HEADERS = {12, 40, 52, 56, 64, 108, 124}


def kind_of(head: bytes) -> str | None:
    """One of `KINDS` by the file's first bytes, None for anything else."""
    for magic, kind in _MAGIC.items():
        if head.startswith(magic):
            return kind
    if head.startswith(_HDF5) or head[512:].startswith(_HDF5):
        return "hdf5"
    if head.startswith(b"RIFF") and head[8:12] == b"AVI ":
        return "avi"
    if head.startswith(b"BM") and int.from_bytes(head[14:18], "little") in _BMP_HEADERS:
        return "bmp"
    return "mp4" if head[4:8] in _QUICKTIME_BOXES else None


def sniff(file: BinaryIO) -> str | None:
    """`kind_of` for an open file, which stands at its start before and after."""
    file.seek(0)
    head = file.read(HEAD_BYTES)
    file.seek(0)
    return kind_of(head)


def not_an_image(name: str) -> FramesError:
    """The error for a file that is no image this program can read."""
    return FramesError("This file is not an image or film.", code="frames.not_an_image", file=name, hint=WHAT_TO_GIVE)


WHAT_TO_GIVE = (
    "Give TIFF, PNG, JPEG or BMP frames in a folder or ZIP, a multi-page TIFF, "
    "an AVI, MP4 or MKV film, or an HDF5, Zarr or ND2 file."
)
