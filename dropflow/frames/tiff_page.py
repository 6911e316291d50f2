"""One page of a TIFF file as pixels, after every number that a decoder would believe was looked at."""

from typing import Any

import numpy as np
import tifffile

from dropflow.errors import FramesError
from dropflow.frames.contract import Frame, check_size
from dropflow.frames.damage import damaged
from dropflow.frames.grey import through_palette

_MAX_RATIOS = {1: 1, 5: 2000, 7: 1032, 8: 1032, 32773: 64, 32946: 1032, 34925: 2**16, 50000: 2**16}
"""None, LZW, JPEG, deflate (two numbers), PackBits, LZMA, Zstandard: how much larger than its data an image may be."""
_JPEG = 7
_MAX_TILE_PIXELS = 2**24


def check_page(page: tifffile.TiffPage, label: str, size_bytes: int) -> None:
    """Refuse a page that is no image, is too large, or whose data is not all in the file of `size_bytes`."""
    check_size(page.imagelength, page.imagewidth, label)
    if page.dtype is None or page.samplesperpixel > 4 or page.imagedepth != 1:
        raise FramesError(
            f"Its pixels are of a kind that is not read ({page.samplesperpixel} samples of {page.bitspersample} bits).",
            code="frames.not_intensities",
            file=label,
        )
    if page.compression not in _MAX_RATIOS:
        raise FramesError(
            f"Its compression ({_name(page.compression)}) is not read.",
            code="frames.unsupported",
            file=label,
            hint="Save it without compression, or with LZW, deflate, PackBits, LZMA, Zstandard or JPEG.",
        )
    if page.is_tiled and page.tilelength * page.tilewidth > max(
        _MAX_TILE_PIXELS, 4 * page.imagelength * page.imagewidth
    ):
        raise FramesError("Its tiles are larger than the image.", code="frames.too_large", file=label)
    check_complete(page, label, size_bytes)
    n_bits = page.imagelength * page.imagewidth * page.samplesperpixel * page.bitspersample
    if n_bits // 8 > _MAX_RATIOS[page.compression] * sum(page.databytecounts):
        raise damaged("TIFF file", "its data is too little for its size", file=label)


def check_complete(page: tifffile.TiffPage, label: str, size_bytes: int) -> None:
    """Refuse a page whose data runs past the end of the file: tifffile would fill it with zeros."""
    ends = [o + n if o and n else size_bytes + 1 for o, n in zip(page.dataoffsets, page.databytecounts, strict=True)]
    if not ends or max(ends) > size_bytes:
        raise FramesError(
            "The file ends before the image does.",
            code="frames.truncated",
            file=label,
            hint="It may be cut off or damaged: copy it again.",
        )


def page_pixels(page: tifffile.TiffPage) -> Frame:
    """Grey (rows, columns), or colour (rows, columns, channels)."""
    if page.compression == _JPEG:
        _check_jpeg(page)
    pixels = page.asarray(maxworkers=1)
    if page.photometric == tifffile.PHOTOMETRIC.MINISWHITE and pixels.dtype.kind == "u":
        return np.iinfo(pixels.dtype).max - pixels
    if page.photometric == tifffile.PHOTOMETRIC.PALETTE and page.colormap is not None:
        return through_palette(pixels, np.asarray(page.colormap).T)
    if pixels.ndim == 3 and page.planarconfig == tifffile.PLANARCONFIG.SEPARATE:
        return np.moveaxis(pixels, 0, -1)
    return pixels


def _check_jpeg(page: tifffile.TiffPage) -> None:
    """Refuse a JPEG strip that is larger than its place: the decoder takes memory for what the strip says."""
    rows, columns = (page.tilelength, page.tilewidth) if page.is_tiled else (page.rowsperstrip, page.imagewidth)
    file = page.parent.filehandle
    for offset, n_bytes in zip(page.dataoffsets, page.databytecounts, strict=True):
        file.seek(offset)
        found = _jpeg_size(file.read(n_bytes))
        if found is None or found[0] > max(rows, page.imagelength) or found[1] > max(columns, page.imagewidth):
            raise ValueError("a JPEG strip does not fit its place")


def _jpeg_size(content: bytes) -> tuple[int, int] | None:
    """Rows and columns as the start-of-frame marker says them (ITU-T T.81, B.2.2)."""
    at = 2
    while content[at : at + 1] == b"\xff":
        marker, length = content[at + 1], int.from_bytes(content[at + 2 : at + 4], "big")
        if 0xC0 <= marker <= 0xCF and marker not in {0xC4, 0xC8, 0xCC}:
            return int.from_bytes(content[at + 5 : at + 7], "big"), int.from_bytes(content[at + 7 : at + 9], "big")
        at += 2 + length
    return None


def _name(compression: Any) -> str:
    return str(getattr(compression, "name", compression))
