"""The one contract of every image stack, and of the files a stack is made of."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any, BinaryIO, Protocol, Self

import numpy as np
import numpy.typing as npt

MAX_FRAME_PIXELS = 2**28
"""A larger frame is refused before memory is taken for it (268 Mpixel; the paper's camera has 5)."""

Frame = npt.NDArray[Any]
"""One grey frame, shape (rows, columns), in the depth it was stored with."""


class Files(Protocol):
    """Named files somewhere: a folder, a ZIP, an object store. Names are data and never become paths elsewhere."""

    def names(self) -> Sequence[str]:
        """All names, ``/`` between folders, in any order."""
        ...

    def open(self, name: str) -> BinaryIO:
        """Open one file for reading; the caller closes it. It can seek."""
        ...


class Frames(ABC):
    """A stack as lazy frames: nothing but the frame asked for is ever in memory.

    Every frame has the `shape` of the first; one that differs raises `FramesError` when it is read. Its depth may
    differ (stills saved by different programs), for nothing here depends on absolute grey levels.
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
