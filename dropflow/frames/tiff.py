"""TIFF files, of one page or many, as frames."""

import logging
import threading
from typing import BinaryIO

import numpy as np
import tifffile

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import Frame, Frames
from dropflow.frames.decode import check_size, to_grey
from dropflow.frames.tiff_chain import count_pages

# What tifffile logs (broken tags, odd metadata) is raised below in our own words where it matters.
logging.getLogger("tifffile").setLevel(logging.CRITICAL)

# All that a damaged file makes tifffile and its codecs raise; they have no common base but Exception.
_DAMAGE = (Exception,)


class TiffFrames(Frames):
    """The pages of one TIFF file, read one at a time from `file`, which is closed with the frames or if they fail."""

    def __init__(self, file: BinaryIO, *, name: str, grey_from: GreyFrom | None = None) -> None:
        self._file, self._name, self._grey_from = file, name, grey_from
        self._lock = threading.Lock()
        self._size_bytes = file.seek(0, 2)
        try:
            self._n_pages = count_pages(file)
            file.seek(0)
            self._tiff = tifffile.TiffFile(file, name=name)
            first = self._read(0)
        except FramesError:
            file.close()
            raise
        except _DAMAGE as problem:
            file.close()
            raise self._damaged(problem) from None
        self.shape = (first.shape[0], first.shape[1])
        self.dtype = first.dtype

    def __len__(self) -> int:
        return self._n_pages

    def label(self, index: int) -> str:
        return self._name if self._n_pages == 1 else f"{self._name}, page {index}"

    def read(self, index: int) -> Frame:
        return same_shape(self._read(index), self, index)

    def close(self) -> None:
        self._tiff.close()
        self._file.close()

    def _read(self, index: int) -> Frame:
        if self._n_pages == 0:
            raise FramesError("The TIFF file holds no image.", code="frames.empty", file=self._name)
        try:
            with self._lock:
                page = self._tiff.pages[index].aspage()
                check_size(page.shape[0], page.shape[1] if len(page.shape) > 1 else 0, self.label(index))
                self._check_complete(page, index)
                pixels = page.asarray(maxworkers=1)
        except FramesError as problem:
            raise FramesError(problem.message, code=problem.code, file=problem.file, frame=index) from None
        except _DAMAGE as problem:
            raise self._damaged(problem, index) from None
        if page.photometric == tifffile.PHOTOMETRIC.MINISWHITE and pixels.dtype.kind == "u":
            pixels = np.iinfo(pixels.dtype).max - pixels
        if pixels.ndim == 3 and page.planarconfig == tifffile.PLANARCONFIG.SEPARATE:
            pixels = np.moveaxis(pixels, 0, -1)
        return to_grey(pixels, self.label(index), self._grey_from)

    def _check_complete(self, page: tifffile.TiffPage, index: int) -> None:
        """Refuse a page whose data runs past the end of the file: tifffile would fill it with zeros."""
        ends = [
            o + n if o and n else self._size_bytes + 1
            for o, n in zip(page.dataoffsets, page.databytecounts, strict=True)
        ]
        if not ends or max(ends) > self._size_bytes:
            raise FramesError("The file ends before the image does.", code="frames.truncated", file=self.label(index))

    def _damaged(self, problem: Exception, index: int | None = None) -> FramesError:
        reason = " ".join(str(problem).split()) or type(problem).__name__
        return FramesError(
            f"The TIFF file cannot be read ({reason}).",
            code="frames.truncated",
            file=self._name,
            frame=index,
            hint="It may be cut off or damaged: copy it again.",
        )


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
