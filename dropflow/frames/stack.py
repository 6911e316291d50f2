"""Many files as one stack of frames."""

from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import Files, Frame, Frames
from dropflow.frames.decode import decode_single, not_an_image, sniff
from dropflow.frames.files import ZipFiles
from dropflow.frames.tiff import TiffFrames, same_shape


class StackFrames(Frames):
    """Frames from named files in the given order, each file holding one frame, or several pages.

    If the first file has one page, so must all others, and they are not opened before they are read: a folder of
    20,000 files opens at once. If it has several, the pages of each file are counted here.
    """

    def __init__(
        self,
        files: Files,
        names: Sequence[str],
        *,
        grey_from: GreyFrom | None = None,
        archive: ZipFiles | None = None,
    ) -> None:
        self._archive = archive
        self._files, self._names, self._grey_from = files, names, grey_from
        first = self._read_pages(names[0])
        n_pages = 1
        if isinstance(first, TiffFrames):
            n_pages = len(first)
            first.close()
        self._n_before = [0, *accumulate(self._count_pages(name) if n_pages > 1 else 1 for name in names)]
        self._is_paged = self._n_before[1] > 1
        frame = self._read_page(0, 0)
        self.shape = (frame.shape[0], frame.shape[1])
        self.dtype = frame.dtype

    def __len__(self) -> int:
        return self._n_before[-1]

    def label(self, index: int) -> str:
        file, page = self._place(index)
        return f"{self._names[file]}, page {page}" if self._is_paged else self._names[file]

    def read(self, index: int) -> Frame:
        try:
            frame = self._read_page(*self._place(index))
        except FramesError as problem:
            raise FramesError(
                problem.message, code=problem.code, file=problem.file, frame=index, hint=problem.hint
            ) from None
        return same_shape(frame, self, index)

    def close(self) -> None:
        """Close the archive; files are opened and closed one at a time."""
        if self._archive:
            self._archive.close()

    def _place(self, index: int) -> tuple[int, int]:
        file = bisect_right(self._n_before, index) - 1
        return file, index - self._n_before[file]

    def _count_pages(self, name: str) -> int:
        with self._open_tiff(name) as pages:
            return len(pages)

    def _open_tiff(self, name: str) -> TiffFrames:
        file = self._files.open(name)
        if sniff(file) != "tiff":
            file.close()
            raise not_an_image(name)
        return TiffFrames(file, name=name, grey_from=self._grey_from)

    def _read_pages(self, name: str) -> TiffFrames | Frame:
        """The pages of a TIFF, or the one frame of any other image file."""
        file = self._files.open(name)
        kind = sniff(file)
        if kind == "tiff":
            return TiffFrames(file, name=name, grey_from=self._grey_from)
        with file:
            if kind not in {"png", "jpeg"}:
                raise not_an_image(name)
            return decode_single(file.read(), name, self._grey_from)

    def _read_page(self, file: int, page: int) -> Frame:
        name = self._names[file]
        pages = self._read_pages(name)
        if not isinstance(pages, TiffFrames):
            return pages
        with pages:
            n_expected = self._n_before[file + 1] - self._n_before[file]
            if len(pages) != n_expected:
                raise FramesError(
                    f"The file holds {len(pages)} pages where {n_expected} is expected.",
                    code="frames.page_count",
                    file=name,
                    hint="Give one frame per file, or files of several pages each.",
                )
            return pages.read(page)
