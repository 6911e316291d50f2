"""One PNG, JPEG or BMP file as a grey frame."""

import io

import numpy as np
from PIL import Image, UnidentifiedImageError

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import Frame, check_size
from dropflow.frames.damage import damaged, reading
from dropflow.frames.grey import through_palette, to_grey
from dropflow.frames.kinds import not_an_image

# The size is checked by us, with an error that says so; Pillow would only warn.
Image.MAX_IMAGE_PIXELS = None

_FORMATS = ("PNG", "JPEG", "BMP")
_MAX_RATIO = 1032
"""How much larger than its file an image may be: deflate, in PNG, comes so far with one colour."""


def decode_single(content: bytes, name: str, grey_from: GreyFrom | None) -> Frame:
    """Decode a PNG, JPEG or BMP file as a grey frame."""
    with reading("image", file=name):
        try:
            image = Image.open(io.BytesIO(content), formats=_FORMATS)
        except UnidentifiedImageError:
            raise not_an_image(name) from None
        with image:
            check_size(image.height, image.width, name)
            if image.height * image.width * len(image.getbands()) > _MAX_RATIO * len(content):
                raise damaged("image", "its data is too little for its size", file=name)
            if getattr(image, "n_frames", 1) > 1 and image.format == "PNG":
                raise FramesError("An animated PNG is no frame.", file=name, hint="Give one file a frame.")
            return to_grey(_pixels(image), name, grey_from)


def _pixels(image: Image.Image) -> Frame:
    """Grey (rows, columns), or colour (rows, columns, channels)."""
    if image.mode == "1":
        return np.asarray(image.convert("L"))
    if image.mode == "P":
        indices = np.asarray(image)
        palette = np.array(image.getpalette("RGB"), np.uint8).reshape(-1, 3)
        return through_palette(indices, palette)
    if image.mode in {"CMYK", "YCbCr", "LAB", "HSV", "PA"}:
        return np.asarray(image.convert("RGB"))
    return np.asarray(image)
