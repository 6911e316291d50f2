"""One image file as a grey array: what it is, is decided by its first bytes, never by its name."""

import io
from typing import Any, BinaryIO

import numpy as np
from PIL import Image, UnidentifiedImageError

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import MAX_FRAME_PIXELS, Frame

# The size is checked by us, with an error that says so; Pillow would only warn.
Image.MAX_IMAGE_PIXELS = None

_MAGIC = {
    b"II*\0": "tiff",
    b"MM\0*": "tiff",
    b"II+\0": "tiff",
    b"MM\0+": "tiff",
    b"\x89PNG\r\n\x1a\n": "png",
    b"\xff\xd8\xff": "jpeg",
    b"PK\x03\x04": "zip",
    b"PK\x05\x06": "zip",
}
MAGIC_BYTES = max(map(len, _MAGIC))
"""How many first bytes `kind_of` wants to see."""

_LUMINANCE = np.array([0.299, 0.587, 0.114], np.float32)


def kind_of(head: bytes) -> str | None:
    """``tiff``, ``png``, ``jpeg`` or ``zip`` by the file's first bytes, None for anything else."""
    return next((kind for magic, kind in _MAGIC.items() if head.startswith(magic)), None)


def sniff(file: BinaryIO) -> str | None:
    """`kind_of` for an open file, which stands at its start before and after."""
    file.seek(0)
    head = file.read(MAGIC_BYTES)
    file.seek(0)
    return kind_of(head)


def not_an_image(name: str) -> FramesError:
    """The error for a file that is no image this program can read."""
    return FramesError(
        "This file is not an image.",
        code="frames.not_an_image",
        file=name,
        hint="Give TIFF, PNG or JPEG frames, a multi-page TIFF, or a ZIP of frames.",
    )


def check_size(rows: int, columns: int, name: str) -> None:
    """Refuse a frame without pixels, or one too large to be a frame, before memory is taken for it."""
    if rows < 1 or columns < 1:
        raise FramesError(f"The image has no pixels ({rows} x {columns}).", file=name)
    if rows * columns > MAX_FRAME_PIXELS:
        raise FramesError(
            f"The image of {rows} x {columns} pixels is larger than {MAX_FRAME_PIXELS} pixels.",
            code="frames.too_large",
            file=name,
        )


def decode_single(content: bytes, name: str, grey_from: GreyFrom | None) -> Frame:
    """Decode a PNG or JPEG file as a grey frame."""
    try:
        with Image.open(io.BytesIO(content), formats=("PNG", "JPEG")) as image:
            check_size(image.height, image.width, name)
            if image.mode in {"1", "P", "CMYK", "YCbCr"}:
                pixels = np.asarray(image.convert("L" if image.mode == "1" else "RGB"))
            else:
                pixels = np.asarray(image)
    except UnidentifiedImageError:
        raise not_an_image(name) from None
    except (OSError, ValueError, SyntaxError, EOFError) as problem:
        raise FramesError(
            f"The image cannot be decoded ({problem}).", code="frames.truncated", file=name, hint="Copy it again."
        ) from None
    return to_grey(pixels, name, grey_from)


def to_grey(pixels: Frame, name: str, grey_from: GreyFrom | None) -> Frame:
    """Drop an alpha channel; turn colour (rows, columns, 3 or 4) into grey as the experiment says, or refuse it."""
    if pixels.ndim == 3 and pixels.shape[2] in {1, 2}:
        pixels = pixels[..., 0]
    if pixels.ndim == 2:
        return _plain(pixels, name)
    if pixels.ndim != 3 or pixels.shape[2] not in {3, 4}:
        raise FramesError(f"An array of shape {pixels.shape} is no frame.", file=name)
    if grey_from is None:
        raise FramesError(
            "The frame is in colour (RGB); grey frames are expected.",
            code="frames.colour",
            file=name,
            hint="Set grey_from in the experiment to luminance, red, green or blue to say how it becomes grey.",
        )
    if grey_from == GreyFrom.LUMINANCE:
        grey = pixels[..., :3].astype(np.float32) @ _LUMINANCE
        return grey if pixels.dtype.kind == "f" else np.rint(grey).astype(pixels.dtype)
    return np.ascontiguousarray(pixels[..., [GreyFrom.RED, GreyFrom.GREEN, GreyFrom.BLUE].index(grey_from)])


def _plain(pixels: Frame, name: str) -> Frame:
    """Real numbers in the machine's own byte order; booleans as 0 and 255."""
    dtype: np.dtype[Any] = pixels.dtype
    if dtype.kind == "b":
        return pixels.astype(np.uint8) * np.uint8(255)
    if dtype.kind not in "uif":
        raise FramesError(f"Pixels of type {dtype} are not intensities.", file=name)
    return np.ascontiguousarray(pixels, dtype=dtype.newbyteorder("="))
