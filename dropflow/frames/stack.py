"""Files of one frame each as one stack."""

from collections.abc import Sequence
from typing import Protocol

from dropflow.frames.choice import Choice, check_single
from dropflow.frames.contract import Files, Frame, Frames, same_shape
from dropflow.frames.damage import Source, of_frame, reading
from dropflow.frames.decode import decode_single
from dropflow.frames.kinds import STILLS, not_an_image, sniff
from dropflow.frames.tiff import read_tiff_still

_MAX_STILL_BYTES = 2**31


class Closeable(Protocol):
    """What is closed with the frames."""

    def close(self) -> None: ...


class StackFrames(Frames):
    """One frame a file, in the order of `names`.

    A file is opened when its frame is read, and closed again: a folder of 20,000 files opens at once.
    """

    def __init__(self, files: Files, names: Sequence[str], *, choice: Choice, archive: Closeable | None = None) -> None:
        self._files, self._names, self._choice, self._archive = files, names, choice, archive
        first = self._still(names[0])
        self.shape = (first.shape[0], first.shape[1])
        self.dtype = first.dtype

    def __len__(self) -> int:
        return len(self._names)

    def label(self, index: int) -> str:
        return self._names[index]

    def read(self, index: int) -> Frame:
        with of_frame(index):
            frame = self._still(self._names[index])
        return same_shape(frame, self, index)

    def file_names(self) -> Sequence[str]:
        return self._names

    def close(self) -> None:
        if self._archive is not None:
            self._archive.close()

    def _still(self, name: str) -> Frame:
        source = Source(self._files.open(name))
        with source, reading("image", file=name, source=source):
            kind = sniff(source.as_file())
            if kind == "tiff":
                return read_tiff_still(source, name=name, choice=self._choice)
            if kind not in STILLS:
                raise not_an_image(name)
            check_single(self._choice, file=name)
            return decode_single(source.read(_MAX_STILL_BYTES), name, self._choice.grey_from)
