"""What every reader of files with frames shares: one read at a time, errors that say where, one shape."""

import threading
from abc import abstractmethod
from typing import ClassVar, Generic, TypeVar

from dropflow.frames.contract import Frame, Frames, same_shape
from dropflow.frames.damage import CanFail, reading

Origin = TypeVar("Origin", bound=CanFail)


class Reader(Frames, Generic[Origin]):
    """The frames in what `source` gives, which is closed with them, or at once if it cannot be opened."""

    what: ClassVar[str]
    """What the file is called in errors."""

    def __init__(self, source: Origin, *, name: str) -> None:
        self._source, self._name = source, name
        self._lock = threading.Lock()
        try:
            with reading(self.what, file=name, source=source):
                self._open()
        except BaseException:
            source.close()
            raise

    @abstractmethod
    def _open(self) -> None:
        """Look at what there is, and set `shape` and `dtype`. May raise whatever it likes."""

    @abstractmethod
    def _read(self, index: int) -> Frame:
        """Frame `index`, grey. May raise whatever it likes."""

    def label(self, index: int) -> str:
        return self._name if len(self) == 1 else f"{self._name}, frame {index}"

    def read(self, index: int) -> Frame:
        with self._lock, reading(self.what, file=self.label(index), frame=index, source=self._source):
            frame = self._read(index)
        return same_shape(frame, self, index)

    def close(self) -> None:
        self._source.close()
