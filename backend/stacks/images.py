"""Frames as pictures for the page: 8 bit, stretched to what the eye sees."""

import threading
from collections import OrderedDict
from collections.abc import Callable
from enum import StrEnum
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.frames import Frame, Frames

_DARK_PERCENTILE, _BRIGHT_PERCENTILE = 0.5, 99.8
_MEASURED_SIDE_PX = 600
"""Percentiles need no more pixels than this squared."""


class PictureKind(StrEnum):
    """How a picture is packed: JPEG is made a hundred times quicker, WebP is smaller."""

    JPEG = "jpg"
    WEBP = "webp"

    @property
    def media_type(self) -> str:
        """As HTTP calls it."""
        return "image/jpeg" if self is PictureKind.JPEG else "image/webp"


_QUALITY = {
    PictureKind.JPEG: [cv2.IMWRITE_JPEG_QUALITY, 88],
    PictureKind.WEBP: [cv2.IMWRITE_WEBP_QUALITY, 85],
}


def as_picture(frame: Frame, max_side_px: int, kind: PictureKind = PictureKind.WEBP) -> bytes:
    """A frame no larger than `max_side_px`, its grey levels stretched between two percentiles."""
    small: npt.NDArray[Any] = np.nan_to_num(frame.astype(np.float32), posinf=0, neginf=0)
    scale = max_side_px / max(small.shape)
    if scale < 1:
        rows, columns = (max(1, round(side * scale)) for side in small.shape)
        small = cv2.resize(small, (columns, rows), interpolation=cv2.INTER_AREA)
    step = max(1, max(small.shape) // _MEASURED_SIDE_PX)
    dark, bright = np.percentile(small[::step, ::step], (_DARK_PERCENTILE, _BRIGHT_PERCENTILE))
    grey = np.clip((small - dark) * (255 / max(bright - dark, 1e-9)), 0, 255).astype(np.uint8)
    is_encoded, content = cv2.imencode(f".{kind}", grey, _QUALITY[kind])
    if not is_encoded:
        raise RuntimeError(f"OpenCV could not encode a {kind} image")
    return content.tobytes()


class _OpenStack:
    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.frames: Frames | None = None
        self.is_closed = False

    def close(self) -> None:
        with self.lock:
            self.is_closed = True
            if self.frames is not None:
                self.frames.close()


class OpenStacks:
    """A few stacks kept open: counting the pages of a long TIFF again for each picture would be slow."""

    def __init__(self, max_open: int = 4) -> None:
        self._max_open = max_open
        self._stacks: OrderedDict[str, _OpenStack] = OrderedDict()
        self._lock = threading.Lock()

    def read(self, key: str, index: int, open_stack: Callable[[], Frames]) -> Frame:
        """Frame `index` of the stack known as `key`, which `open_stack` opens if it is not open yet."""
        while True:
            stack = self._stack(key)
            with stack.lock:
                if stack.is_closed:
                    continue  # it gave way to others in between
                if stack.frames is None:
                    stack.frames = open_stack()
                return stack.frames.read(index)

    def close(self) -> None:
        """Close all of them."""
        with self._lock:
            stacks, self._stacks = self._stacks, OrderedDict()
        for stack in stacks.values():
            stack.close()

    def _stack(self, key: str) -> _OpenStack:
        closing = []
        with self._lock:
            stack = self._stacks.setdefault(key, _OpenStack())
            self._stacks.move_to_end(key)
            while len(self._stacks) > self._max_open:
                closing.append(self._stacks.popitem(last=False)[1])
        for old in closing:
            old.close()
        return stack
