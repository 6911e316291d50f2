"""A stack without the frames of it that cannot be read."""

from collections.abc import Sequence

from dropflow.frames.contract import Frame, Frames, Times
from dropflow.frames.findings import Finding


class ReadableFrames(Frames):
    """The frames of `all_frames` except `left_out`, counted anew from 0; where they come from is said as before."""

    def __init__(self, all_frames: Frames, left_out: Sequence[int]) -> None:
        self._all = all_frames
        missing = set(left_out)
        self._kept = [index for index in range(len(all_frames)) if index not in missing]
        self.shape, self.dtype = all_frames.shape, all_frames.dtype

    def __len__(self) -> int:
        return len(self._kept)

    def label(self, index: int) -> str:
        return self._all.label(self._kept[index])

    def read(self, index: int) -> Frame:
        return self._all.read(self._kept[index])

    def times_s(self) -> Times | None:
        times_s = self._all.times_s()
        return None if times_s is None else times_s[self._kept]

    def findings(self) -> tuple[Finding, ...]:
        return self._all.findings()

    def close(self) -> None:
        self._all.close()
