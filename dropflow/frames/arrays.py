"""Arrays of numbers as stacks: which axis counts the frames, and what is refused before anything is read."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.frames.contract import Frame, check_count, check_size

_MAX_BLOCK_BYTES = 2**30
_MAX_BLOCKS_IN_FRAME = 2**16
_MAX_SLAB_BYTES = 2**28
_COLOURS = {3, 4}


@dataclass(frozen=True)
class ArrayShape:
    """How an array is a stack."""

    n_frames: int
    has_frame_axis: bool
    """Whether the first axis counts frames; else the array is one frame."""


def array_shape(
    shape: Sequence[int] | None, dtype: np.dtype[Any], label: str, *, is_transposed: bool = False
) -> ArrayShape:
    """(frames, rows, columns), (frames, rows, columns, colours) or (rows, columns); anything else is an error."""
    if not is_stack(shape, dtype) or shape is None:
        raise FramesError(
            f"An array of shape {shape} and type {dtype} is no stack of frames.",
            code="frames.not_a_stack",
            file=label,
            hint="It must have the axes (frame, row, column) and hold numbers.",
        )
    has_frame_axis = len(shape) > 2
    rows, columns = shape[1:3] if has_frame_axis else shape
    check_size(*((columns, rows) if is_transposed else (rows, columns)), label)
    n_frames = shape[0] if has_frame_axis else 1
    check_count(n_frames, label)
    return ArrayShape(n_frames, has_frame_axis)


def is_stack(shape: Sequence[int] | None, dtype: np.dtype[Any]) -> bool:
    """Whether an array may be a stack of frames by its shape and type."""
    if shape is None or dtype.kind not in "buif" or dtype.itemsize > 8:
        return False
    return len(shape) in {2, 3} or (len(shape) == 4 and shape[3] in _COLOURS)


def check_block(shape: Sequence[int], block: Sequence[int], dtype: np.dtype[Any], label: str) -> None:
    """Refuse an array whose blocks (chunks) would each take too much memory to unpack, or be too many in a frame."""
    n_in_frame = prod(-(-n // step) for n, step in zip(shape[-2:], block[-2:], strict=True))
    if n_in_frame > _MAX_BLOCKS_IN_FRAME:
        raise FramesError(
            f"A frame is stored in {n_in_frame:,} blocks; {_MAX_BLOCKS_IN_FRAME:,} is the most.",
            code="frames.too_large",
            file=label,
            hint="Store it again in larger blocks (chunks).",
        )
    n_bytes = prod(block) * dtype.itemsize
    if n_bytes > _MAX_BLOCK_BYTES:
        raise FramesError(
            f"It is stored in blocks of {n_bytes:,} bytes; {_MAX_BLOCK_BYTES:,} is the most.",
            code="frames.too_large",
            file=label,
            hint="Store it again in blocks (chunks) of one frame or a few.",
        )


class Slabs:
    """Frames that are stored in blocks of several: the block that was unpacked last is kept for those that follow."""

    def __init__(
        self, read: Callable[[int, int], npt.NDArray[Any]], *, n_in_block: int, n_frames: int, frame_bytes: int
    ) -> None:
        self._read, self._n_frames = read, n_frames
        self._n_kept = n_in_block if n_in_block * frame_bytes <= _MAX_SLAB_BYTES else 1
        self._start, self._slab = 0, np.empty(0)

    def frame(self, index: int) -> Frame:
        """Frame `index` as it is stored, a copy."""
        if not self._start <= index < self._start + len(self._slab):
            self._slab = np.empty(0)  # given back before the next is taken
            self._start = index - index % self._n_kept
            self._slab = self._read(self._start, min(self._start + self._n_kept, self._n_frames))
        return np.array(self._slab[index - self._start])
