"""Nikon ND2 files as frames, through the package nd2 (`pip install dropflow[nd2]`)."""

import zlib
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from dropflow.errors import FramesError
from dropflow.frames.choice import Axes, Choice, pick, select
from dropflow.frames.contract import Frame, Times, check_count, check_size
from dropflow.frames.damage import Source, reading
from dropflow.frames.findings import Finding
from dropflow.frames.grey import to_grey
from dropflow.frames.reader import Reader
from dropflow.frames.tiff_plan import fewer

_TIMES = b"CustomData|AcqTimesCache!"
_FRAME_HEADER_BYTES = 4096
"""Between where a frame's chunk begins and its pixels."""
_MAX_FRAME_BYTES = 2**30
_INFLATING = {"nd2._parse._clx_lite": 2**24, "nd2._readers._modern.modern_reader": _MAX_FRAME_BYTES}
"""The modules of nd2 that inflate metadata and frames, and how many bytes each may make at once."""


class _BoundedZlib:
    """What nd2 calls to inflate, with an end: a few hostile kilobytes would otherwise fill the memory."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes

    def decompress(self, content: bytes) -> bytes:
        stream = zlib.decompressobj()
        inflated = stream.decompress(content, self._max_bytes)
        if stream.unconsumed_tail:
            raise ValueError(f"it inflates to more than {self._max_bytes:,} bytes")
        return inflated


@cache
def _package() -> Any:
    """The package nd2, with every inflating in it bounded."""
    for inflating, max_bytes in _INFLATING.items():
        vars(import_module(inflating))["zlib"] = _BoundedZlib(max_bytes)
    return import_module("nd2")


class Nd2Frames(Reader[Source]):
    """The frames of one channel, z-plane and position."""

    what = "ND2 file"

    def __init__(self, source: Source, *, name: str, choice: Choice) -> None:
        self._choice = choice
        super().__init__(source, name=name)

    def _open(self) -> None:
        if find_spec("nd2") is None:
            raise FramesError(
                "ND2 files are read by a package that is not installed.",
                code="frames.not_installed",
                file=self._name,
                hint="Install it: pip install 'dropflow[nd2]'.",
            )
        self._file = _package().ND2File(self._source)
        self._check_layout()
        self._chunks: dict[bytes, tuple[int, int]] = self._file._rdr.chunkmap
        self._places = self._select()
        first = self._read(0)
        self.shape, self.dtype = (first.shape[0], first.shape[1]), first.dtype

    def __len__(self) -> int:
        return len(self._places)

    def close(self) -> None:
        with self._lock:
            self._file.close()
            super().close()

    def times_s(self) -> Times | None:
        if _TIMES not in self._chunks:
            return None
        with self._lock, reading(self.what, file=self._name, source=self._source):
            content: bytes = self._file._rdr._load_chunk(_TIMES)
        times_ms = np.frombuffer(content[: len(content) // 8 * 8], np.float64)
        there = np.array(self._places) < len(times_ms)
        times_s = np.full(len(self), np.nan)
        times_s[there] = times_ms[np.array(self._places)[there]] / 1000
        return times_s

    def findings(self) -> tuple[Finding, ...]:
        return self._findings

    def _check_layout(self) -> None:
        about = self._file.attributes
        check_size(about.heightPx, about.widthPx or 0, self._name)
        if about.heightPx * about.widthBytes > _MAX_FRAME_BYTES:
            raise FramesError("Its frames are too large.", code="frames.too_large", file=self._name)
        if about.compressionType == "lossy":
            raise FramesError(
                "Its frames are compressed with loss, which is not read.",
                code="frames.unsupported",
                file=self._name,
                hint="Save it as TIFF in NIS-Elements.",
            )

    def _select(self) -> list[int]:
        """Number of each frame in the file, in the order of time."""
        loops = self._file.experiment
        n_said = int(np.prod([loop.count for loop in loops], dtype=object))
        check_count(n_said, self._name)
        sizes = {"T": 1, "Z": 1, "P": 1}
        for axes in self._file.loop_indices[-1:]:
            sizes.update({axis: last + 1 for axis, last in axes.items()})
        if not loops:
            sizes["T"] = n_said = self._file.attributes.sequenceCount
            check_count(n_said, self._name)
        if set(sizes) - {"T", "Z", "P"}:
            raise FramesError("It runs along axes that are not read.", code="frames.unsupported", file=self._name)
        position = pick("position", sizes["P"], self._choice.position, file=self._name)
        n_channels = self._file.attributes.channelCount or 1
        axes = Axes(sizes["T"], sizes["Z"], n_channels, self._channel_names() if n_channels > 1 else ())
        chosen = select(axes, self._choice, file=self._name)
        self._channel = chosen.channel
        if loops:
            number = {
                (at.get("T", 0), at.get("Z", 0), at.get("P", 0)): index
                for index, at in enumerate(self._file.loop_indices)
            }
        else:
            number = {(index, 0, 0): index for index in range(n_said)}
        places = [number[(*chosen.place(index), position)] for index in range(chosen.n)]
        n_there = max((at + 1 for at, place in enumerate(places) if _chunk(place) in self._chunks), default=0)
        check_count(n_there, self._name)
        self._findings = fewer(n_there, len(places))
        return places[:n_there]

    def _channel_names(self) -> tuple[str, ...]:
        """For an error's sake; they stand among much that differs from microscope to microscope."""
        try:
            return tuple(channel.channel.name or "" for channel in self._file.metadata.channels)
        except Exception:
            return ()

    def _read(self, index: int) -> Frame:
        place = self._places[index]
        about = self._file.attributes
        if _chunk(place) not in self._chunks:
            raise FramesError("The frame is not in the file.", code="frames.missing", file=self._name, frame=index)
        is_raw = about.compressionType != "lossless"
        end = self._chunks[_chunk(place)][0] + _FRAME_HEADER_BYTES + about.heightPx * about.widthBytes
        if is_raw and end > self._source.size_bytes:
            raise FramesError("The file ends before the image does.", code="frames.truncated", file=self._name)
        n_channels = about.channelCount or 1
        shape = (n_channels, about.heightPx, about.widthPx, about.componentCount // n_channels)
        pixels = self._file.read_frame(place).reshape(shape)[self._channel]
        return to_grey(pixels, self.label(index), self._choice.grey_from)


def _chunk(place: int) -> bytes:
    return b"ImageDataSeq|%d!" % place
