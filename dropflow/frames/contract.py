"""The one contract of every image stack, and of the files a stack is made of."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO, Protocol, Self

import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.frames.findings import Finding

MAX_FRAME_PIXELS = 2**28
"""A larger frame is refused before memory is taken for it (268 Mpixel; the paper's camera has 5)."""

MAX_FRAMES = 5_000_000
"""A longer stack is refused: 2,000 times the paper's."""

Frame = npt.NDArray[Any]
"""One grey frame, shape (rows, columns), in the depth it was stored with."""

Times = npt.NDArray[np.float64]
"""Time of each frame in seconds, shape (n_frames,)."""


class Files(Protocol):
    """Named files somewhere: a folder, a ZIP, an object store. Names are data and never become paths elsewhere."""

    def names(self) -> Sequence[str]:
        """All names, ``/`` between folders, in any order."""
        ...

    def open(self, name: str) -> BinaryIO:
        """Open one of the names for reading; the caller closes it. It can seek, and reads are ranges."""
        ...


class Frames(ABC):
    """A stack as lazy frames: no more than a frame (or the block it is stored in) is ever in memory.

    Every frame has the `shape` of the first; one that differs raises `FramesError` when it is read. Its depth may
    differ (stills saved by different programs), for nothing here depends on absolute grey levels. Its pixels are
    finite numbers in the byte order of the machine. Frames may be read from several threads.
    """

    shape: tuple[int, int]
    """Rows and columns."""
    dtype: np.dtype[Any]
    """Of the first frame."""

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def label(self, index: int) -> str:
        """Where frame `index` comes from (file, page), for errors and for people."""

    @abstractmethod
    def read(self, index: int) -> Frame:
        """Frame `index`, 0 <= index < len(self). Raises `FramesError` naming file and frame."""

    @abstractmethod
    def close(self) -> None:
        """Close the files behind the frames."""

    def times_s(self) -> Times | None:
        """When each frame was taken by the file's own account, from any beginning; None where it says nothing.

        As the file says it: NaN for a frame it does not know, and not checked to increase.
        """
        return None

    def file_names(self) -> Sequence[str]:
        """Where frames lie in several files: their names, in the order of the frames. One a frame, or one a part."""
        return ()

    def findings(self) -> tuple[Finding, ...]:
        """What the reader noticed that is no error."""
        return ()

    def __getitem__(self, index: int) -> Frame:
        if not 0 <= index < len(self):
            raise IndexError(index)
        return self.read(index)

    def __iter__(self) -> Iterator[Frame]:
        return (self.read(index) for index in range(len(self)))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def same_shape(frame: Frame, frames: Frames, index: int) -> Frame:
    """Return `frame`, or raise if its shape is not that of the first of `frames`."""
    if frame.shape != frames.shape:
        raise FramesError(
            f"The frame is {frame.shape[0]} x {frame.shape[1]} pixels, "
            f"but the first is {frames.shape[0]} x {frames.shape[1]}.",
            code="frames.shape_mismatch",
            file=frames.label(index),
            frame=index,
            hint="All frames of one film must have one size.",
        )
    return frame


def check_size(rows: int, columns: int, name: str) -> None:
    """Refuse a frame without pixels, or one too large to be a frame, before memory is taken for it."""
    if rows < 1 or columns < 1:
        raise FramesError(f"The image has no pixels ({rows} x {columns}).", code="frames.no_pixels", file=name)
    if rows * columns > MAX_FRAME_PIXELS:
        raise FramesError(
            f"The image of {rows} x {columns} pixels is larger than {MAX_FRAME_PIXELS} pixels.",
            code="frames.too_large",
            file=name,
        )


def check_count(n_frames: int, name: str) -> None:
    """Refuse a stack without frames, or one too long to be a film."""
    if n_frames < 1:
        raise FramesError("The file holds no frames.", code="frames.empty", file=name)
    if n_frames > MAX_FRAMES:
        raise FramesError(
            f"The file says it holds {n_frames:,} frames; {MAX_FRAMES:,} is the most.",
            code="frames.too_large",
            file=name,
        )
