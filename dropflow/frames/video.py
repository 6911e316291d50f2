"""AVI, MP4 and MKV films as frames. A frame is decoded from the last key frame before it, and none is kept."""

from collections.abc import Iterator
from typing import Any, BinaryIO

import av
import numpy as np
from av.video.frame import VideoFrame, supported_np_pix_fmts

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.choice import Choice, check_single
from dropflow.frames.contract import Frame, Times, check_count, check_size
from dropflow.frames.damage import Source
from dropflow.frames.grey import colour_error, through_palette, to_grey
from dropflow.frames.reader import Reader
from dropflow.frames.video_index import index_of

# FFmpeg writes what it thinks of damaged files to standard error.
av.logging.set_level(av.logging.PANIC)

_FORMATS = {"avi": "avi", "mp4": "mov", "mkv": "matroska"}
_GREY = {name for name in supported_np_pix_fmts if name.startswith("gray")}
"""Read as stored."""
_TO_GREY = {"monow": "gray", "monob": "gray", "ya8": "gray", "ya16le": "gray16le", "ya16be": "gray16le"}
"""One bit, and grey with alpha."""
_MAX_PIXELS = 2**26
"""Less than of other frames, for a decoder keeps up to 16 of them."""
_PALETTE = "pal8"
_BITS_OF_A_BYTE = 8


class VideoFrames(Reader[Source]):
    """The frames of the first video stream of a file."""

    what = "video"

    def __init__(self, source: Source, *, name: str, choice: Choice, kind: str) -> None:
        self._choice, self._kind = choice, kind
        self._decoded: Iterator[VideoFrame] = iter(())
        self._position: int | None = None
        """Of the frame that was decoded last, in stamps."""
        super().__init__(source, name=name)

    def _open(self) -> None:
        check_single(self._choice, file=self._name)
        # The format is given, for FFmpeg would also open lists of other files and addresses; those it may not open.
        self._container = av.open(
            self._source,
            "r",
            format=_FORMATS[self._kind],
            io_open=_refuse,
            options={"max_pixels": str(_MAX_PIXELS)},
        )
        streams = self._container.streams.video
        if not streams:
            raise FramesError("The file holds no video.", code="frames.empty", file=self._name)
        self._stream = streams[0]
        context = self._stream.codec_context
        context.thread_type, context.thread_count = "NONE", 1
        context.options = {"max_pixels": str(_MAX_PIXELS)}
        check_size(context.height, context.width, self._name)
        if context.pix_fmt == _PALETTE:
            # The palette comes with the first packet alone, and a decoder that has seen it keeps it.
            next(self._container.decode(self._stream), None)
            self._container.seek(self._stream.start_time or 0, stream=self._stream, backward=True)
        self._index = index_of(self._container, self._stream)
        check_count(len(self._index.stamps), self._name)
        first = self._read(0)
        self.shape, self.dtype = (first.shape[0], first.shape[1]), first.dtype

    def __len__(self) -> int:
        return len(self._index.stamps)

    def close(self) -> None:
        with self._lock:
            self._decoded = iter(())
            self._container.close()
            super().close()

    def times_s(self) -> Times | None:
        if self._index.is_by_count:
            rate = self._stream.average_rate
            return np.arange(len(self), dtype=np.float64) / float(rate) if rate else None
        base = self._stream.time_base
        if base is None:
            return None
        stamps = np.array(self._index.stamps, np.float64)
        times_s: Times = (stamps - stamps[0]) * float(base)
        return times_s

    def _read(self, index: int) -> Frame:
        stamp = self._index.stamps[index]
        position, self._position = self._position, None  # unknown again if this fails
        if position is None or not self._index.is_near(position, stamp):
            position = self._seek(stamp)
        found = self._decode_to(stamp, position)
        if found is None:
            raise ValueError("the frame cannot be decoded")
        self._position = stamp
        return _grey(found, self.label(index), self._choice.grey_from)

    def _seek(self, stamp: int) -> int:
        """Go to the last place from which the frame at `stamp` can be decoded; say where that is."""
        self._decoded = iter(())
        start = (self._stream.start_time or 0) if self._index.is_by_count else self._index.key_before(stamp)
        self._container.seek(start, stream=self._stream, backward=True)
        self._decoded = self._container.decode(self._stream)
        return -1

    def _decode_to(self, stamp: int, position: int) -> VideoFrame | None:
        """The frame shown at `stamp`, None if decoding passes it."""
        for frame in self._decoded:
            if self._index.is_by_count:
                position += 1
            elif frame.pts is not None:
                position = frame.pts
            if position >= stamp:
                return frame if position == stamp else None
        return None


def _refuse(url: str, flags: int, options: dict[str, Any]) -> BinaryIO:  # noqa: ARG001 - as PyAV calls it
    raise PermissionError("it names another file")


def _grey(frame: VideoFrame, label: str, grey_from: GreyFrom | None) -> Frame:
    """The frame as it was stored if it is grey, else what `grey_from` says."""
    check_size(frame.height, frame.width, label)
    name = frame.format.name
    if name in _GREY:
        return to_grey(frame.to_ndarray(), label, grey_from)
    if name == _PALETTE:
        indices, palette = frame.to_ndarray()
        return to_grey(through_palette(indices, palette[:, 1:]), label, grey_from)
    if name in _TO_GREY:
        return to_grey(frame.reformat(format=_TO_GREY[name]).to_ndarray(), label, grey_from)
    if grey_from is None:
        raise colour_error(label)
    is_deep = any(component.bits > _BITS_OF_A_BYTE for component in frame.format.components)
    return to_grey(frame.reformat(format="rgb48le" if is_deep else "rgb24").to_ndarray(), label, grey_from)
