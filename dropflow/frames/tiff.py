"""TIFF files, of one page or many, as frames: classic, BigTIFF, ImageJ, OME."""

import logging

import numpy as np
import tifffile

from dropflow.errors import FramesError
from dropflow.frames.choice import Choice
from dropflow.frames.contract import Frame, Times, check_count
from dropflow.frames.damage import Source, reading
from dropflow.frames.findings import Finding
from dropflow.frames.grey import to_grey
from dropflow.frames.reader import Reader
from dropflow.frames.tiff_chain import page_offsets
from dropflow.frames.tiff_page import check_page, page_pixels
from dropflow.frames.tiff_plan import Plan, plan

# What tifffile logs (broken tags, odd metadata) is raised below in our own words where it matters.
logging.getLogger("tifffile").setLevel(logging.CRITICAL)


class TiffFrames(Reader[Source]):
    """The pages of one TIFF file, read one at a time."""

    what = "TIFF file"
    _tiff: tifffile.TiffFile
    _plan: Plan
    _waiting: Frame | None = None
    """Frame 0, which had to be read to know its size, until it is asked for."""

    def __init__(self, source: Source, *, name: str, choice: Choice) -> None:
        self._choice = choice
        super().__init__(source, name=name)

    def _open(self) -> None:
        file = self._source.as_file()
        self._offsets = page_offsets(file)
        check_count(len(self._offsets), self._name)
        file.seek(0)
        # Never the other files of a set: their names come from this one.
        self._tiff = tifffile.TiffFile(file, name=self._name, _multifile=False)
        self._plan = plan(self._page(0), len(self._offsets), self._choice, self._name)
        self._waiting = self._read(0)
        self.shape = (self._waiting.shape[0], self._waiting.shape[1])
        self.dtype = self._waiting.dtype

    def __len__(self) -> int:
        return len(self._plan.pages)

    def label(self, index: int) -> str:
        return self._name if len(self) == 1 else f"{self._name}, page {self._plan.pages[index]}"

    def times_s(self) -> Times | None:
        return self._plan.times_s

    def findings(self) -> tuple[Finding, ...]:
        return self._plan.findings

    def _read(self, index: int) -> Frame:
        if index == 0 and self._waiting is not None:
            frame, self._waiting = self._waiting, None
            return frame
        label = self.label(index)
        page = self._page(0 if self._plan.is_one_block else self._plan.pages[index])
        check_page(page, label, self._source.size_bytes)
        pixels = self._in_block(page, self._plan.pages[index], label) if self._plan.is_one_block else page_pixels(page)
        return to_grey(pixels, label, self._choice.grey_from)

    def _page(self, number: int) -> tifffile.TiffPage:
        self._tiff.filehandle.seek(self._offsets[number])
        return tifffile.TiffPage(self._tiff, number)

    def _in_block(self, page: tifffile.TiffPage, place: int, label: str) -> Frame:
        """The frame at this place in a block of frames that follow each other without compression."""
        if not page.is_contiguous or page.dtype is None:
            raise ValueError(f"it says it holds {len(self)} frames, but has one page")
        dtype = np.dtype(page.dtype).newbyteorder(page.parent.byteorder)
        n_bytes = dtype.itemsize * page.imagelength * page.imagewidth * page.samplesperpixel
        start = page.dataoffsets[0] + place * n_bytes
        if start + n_bytes > self._source.size_bytes:
            raise FramesError("The file ends before the image does.", code="frames.truncated", file=label)
        self._source.seek(start)
        pixels = np.frombuffer(self._source.read(n_bytes), dtype)
        shape = (page.imagelength, page.imagewidth)
        return pixels.reshape(shape if page.samplesperpixel == 1 else (*shape, page.samplesperpixel))


def read_tiff_still(source: Source, *, name: str, choice: Choice) -> Frame:
    """The one frame of a TIFF file, which is closed."""
    with reading("TIFF file", file=name, source=source), TiffFrames(source, name=name, choice=choice) as frames:
        if len(frames) != 1:
            raise FramesError(
                f"The file holds {len(frames)} pages where 1 is expected.",
                code="frames.page_count",
                file=name,
                hint="Give one frame per file, or files of several pages each.",
            )
        return frames.read(0)
