"""Pixels of any kind as one grey frame of finite numbers, by the rule that the experiment states."""

from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import Frame

_LUMINANCE = np.array([0.299, 0.587, 0.114], np.float32)
_ROWS_AT_ONCE = 64
_CHANNELS = [GreyFrom.RED, GreyFrom.GREEN, GreyFrom.BLUE]


def to_grey(pixels: Frame, name: str, grey_from: GreyFrom | None) -> Frame:
    """Drop an alpha channel; turn colour (rows, columns, 3 or 4) into grey as the experiment says, or refuse it."""
    if pixels.ndim == 3 and pixels.shape[2] in {1, 2}:
        pixels = pixels[..., 0]
    if pixels.ndim == 2:
        return _plain(pixels, name)
    if pixels.ndim != 3 or pixels.shape[2] not in {3, 4}:
        raise FramesError(f"An array of shape {pixels.shape} is no frame.", file=name)
    if grey_from is None:
        raise colour_error(name)
    if grey_from == GreyFrom.LUMINANCE:
        return _plain(_luminance(pixels), name)
    return _plain(pixels[..., _CHANNELS.index(grey_from)], name)


def colour_error(name: str) -> FramesError:
    """The error for a colour frame of an experiment that does not say how it becomes grey."""
    return FramesError(
        "The frame is in colour (RGB); grey frames are expected.",
        code="frames.colour",
        file=name,
        hint="Set grey_from in the experiment to luminance, red, green or blue to say how it becomes grey.",
    )


def through_palette(indices: Frame, palette: npt.NDArray[Any]) -> Frame:
    """Look indices up in a palette, shape (n_colours, 3): (rows, columns) if all its colours are grey, else colour."""
    is_grey = bool((palette == palette[:, :1]).all())
    return np.take(palette[:, 0] if is_grey else palette, indices, axis=0)


def _luminance(pixels: Frame) -> Frame:
    """Grey in the depth of the colours, some rows at a time: as floats a whole frame would take four times the room."""
    dtype = pixels.dtype if pixels.dtype.kind in "uif" else np.dtype(np.float32)
    weights = _LUMINANCE.astype(np.result_type(dtype, np.float32))
    grey = np.empty(pixels.shape[:2], dtype)
    for start in range(0, len(grey), _ROWS_AT_ONCE):
        rows = pixels[start : start + _ROWS_AT_ONCE, :, :3] @ weights
        grey[start : start + _ROWS_AT_ONCE] = rows if dtype.kind == "f" else np.rint(rows)
    return grey


def _plain(pixels: Frame, name: str) -> Frame:
    """Finite real numbers in the machine's own byte order; booleans as 0 and 255."""
    dtype: np.dtype[Any] = pixels.dtype
    if dtype.kind == "b":
        return pixels.astype(np.uint8) * np.uint8(255)
    if dtype.kind not in "uif":
        raise FramesError(f"Pixels of type {dtype} are not intensities.", code="frames.not_intensities", file=name)
    if dtype.kind == "f":
        _check_finite(pixels, name)
        dtype = np.dtype(np.float32 if dtype.itemsize <= 4 else np.float64)
    return np.ascontiguousarray(pixels, dtype=dtype.newbyteorder("="))


def _check_finite(pixels: Frame, name: str) -> None:
    n_wrong = pixels.size - int(np.count_nonzero(np.isfinite(pixels)))
    if n_wrong:
        raise FramesError(
            f"{n_wrong} of {pixels.size} pixels are not finite numbers (NaN or infinite).",
            code="frames.not_finite",
            file=name,
            hint="Every pixel must have an intensity: write the frames again without masked pixels.",
        )
