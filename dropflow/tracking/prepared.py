"""Frames read and prepared ahead, in a thread of their own, while droplets are followed in the one before."""

from concurrent.futures import Future, ThreadPoolExecutor

from dropflow.detection.contract import Detector, Image
from dropflow.frames import Frames


class PreparedFrames:
    """Prepared frames of a film, two in memory at most. All reading is done in the one thread."""

    def __init__(self, frames: Frames, detector: Detector) -> None:
        self._frames = frames
        self._detector = detector
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="prepare")
        self._coming: dict[int, Future[Image]] = {}

    def expect(self, frame: int, then: int) -> None:
        """Have a frame ready, and the one that is wanted after it; forget all others."""
        for other in self._coming.keys() - {frame, then}:
            self._coming.pop(other).cancel()
        for one in (frame, then):
            if 0 <= one < len(self._frames) and one not in self._coming:
                self._coming[one] = self._thread.submit(self._prepare, one)

    def get(self, frame: int) -> Image:
        """A frame that was expected; raises what reading or preparing it raised."""
        return self._coming[frame].result()

    def close(self) -> None:
        """Let go; no frame is read after this."""
        self._coming.clear()
        self._thread.shutdown(cancel_futures=True)

    def _prepare(self, frame: int) -> Image:
        return self._detector.prepare(self._frames[frame])
