"""How fast work goes: seconds a frame, and how much that differs from stretch to stretch."""

import math


class Pace:
    """Stretches of work between marks.

    The first frame does not count, unless it is the only one: with it goes what is compiled and opened once.
    """

    def __init__(self, now_s: float) -> None:
        self.n_samples = 0
        self.n_frames = 0.0
        self._worked_s = 0.0
        self._squares = 0.0
        self._first = self._last = (0.0, now_s)

    def mark(self, n_done: float, now_s: float, *, is_last: bool = False) -> None:
        """So many frames are done by now."""
        is_first = self._last is self._first
        if not is_first or is_last:
            self._add(n_done - self._last[0], now_s - self._last[1])
        self._last = (n_done, now_s)

    def _add(self, n_frames: float, worked_s: float) -> None:
        if n_frames <= 0:
            return
        self.n_samples += 1
        self.n_frames += n_frames
        self._worked_s += worked_s
        self._squares += worked_s**2 / n_frames

    @property
    def mean_s(self) -> float | None:
        """Seconds a frame."""
        return self._worked_s / self.n_frames if self.n_frames else None

    @property
    def std_s(self) -> float | None:
        """Standard deviation of the seconds a frame between stretches, weighted by their frames."""
        if not self.n_frames:
            return None
        return math.sqrt(max(self._squares / self.n_frames - (self._worked_s / self.n_frames) ** 2, 0.0))
