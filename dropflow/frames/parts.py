"""Several files of many frames each as one stack: the parts of a film that was split."""

import threading
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import accumulate

import numpy as np

from dropflow.frames.contract import Frame, Frames, Times, same_shape
from dropflow.frames.damage import of_frame
from dropflow.frames.findings import Finding
from dropflow.frames.stack import Closeable


class PartFrames(Frames):
    """The frames of each file after those of the file before it. One file is open at a time.

    Every file is opened once here, to count its frames.
    """

    def __init__(
        self, names: Sequence[str], open_part: Callable[[str], Frames], *, archive: Closeable | None = None
    ) -> None:
        self._names, self._open_part, self._archive = names, open_part, archive
        self._lock = threading.Lock()
        self._open: tuple[int, Frames] | None = None
        counts: list[int] = []
        times_s: list[Times | None] = []
        self._findings: list[Finding] = []
        for name in names:
            with open_part(name) as part:
                if not counts:
                    self.shape, self.dtype = part.shape, part.dtype
                counts.append(len(part))
                times_s.append(part.times_s())
                self._findings.extend(part.findings())
        self._n_before = [0, *accumulate(counts)]
        self._times_s = times_s

    def __len__(self) -> int:
        return self._n_before[-1]

    def label(self, index: int) -> str:
        part, inside = self._place(index)
        return f"{self._names[part]}, frame {inside}"

    def read(self, index: int) -> Frame:
        part, inside = self._place(index)
        with self._lock, of_frame(index):
            frame = self._part(part).read(inside)
        return same_shape(frame, self, index)

    def times_s(self) -> Times | None:
        """Those of the parts if they go on from part to part, as those of OME-TIFF do."""
        known = [times_s for times_s in self._times_s if times_s is not None]
        if len(known) < len(self._times_s):
            return None
        joined = np.concatenate(known)
        return joined if bool(np.all(np.diff(joined) > 0)) else None

    def findings(self) -> tuple[Finding, ...]:
        return tuple(self._findings)

    def file_names(self) -> Sequence[str]:
        return self._names

    def close(self) -> None:
        with self._lock:
            if self._open is not None:
                self._open[1].close()
                self._open = None
        if self._archive is not None:
            self._archive.close()

    def _place(self, index: int) -> tuple[int, int]:
        part = bisect_right(self._n_before, index) - 1
        return part, index - self._n_before[part]

    def _part(self, number: int) -> Frames:
        if self._open is None or self._open[0] != number:
            if self._open is not None:
                self._open[1].close()
                self._open = None
            self._open = (number, self._open_part(self._names[number]))
        return self._open[1]
