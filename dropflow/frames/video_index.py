"""Where the frames of a video are: one entry a frame, in the order in which they are shown."""

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

from av.container import InputContainer
from av.packet import Packet
from av.video.stream import VideoStream

from dropflow.frames.contract import MAX_FRAMES


@dataclass(frozen=True)
class VideoIndex:
    """The frames of a video."""

    stamps: list[int]
    """When each frame is shown, in units of the stream's time base, increasing."""
    key_stamps: list[int] = field(default_factory=list)
    """Those of frames that can be decoded on their own. Empty: only the beginning is known to be one."""
    is_by_count: bool = False
    """Its frames carry no usable stamps: they are found by counting from the beginning."""

    def key_before(self, stamp: int) -> int:
        """The last place from which the frame at `stamp` can be decoded."""
        at = bisect_right(self.key_stamps, stamp)
        return self.key_stamps[at - 1] if at else self.stamps[0]

    def is_near(self, now: int, target: int) -> bool:
        """Whether decoding on from `now` reaches `target` without passing a better place to begin."""
        return now < target and (self.is_by_count or self.key_before(target) <= now)


def index_of(container: InputContainer, stream: VideoStream) -> VideoIndex:
    """Find every frame: from the file's own list of them if that is complete, else by reading the file once."""
    return _listed(container, stream) or _walked(container, stream)


def _listed(container: InputContainer, stream: VideoStream) -> VideoIndex | None:
    """From the list in AVI and MP4 files. Only if every frame stands alone is the order in it the order of showing."""
    if stream.frames < 1 or stream.frames > MAX_FRAMES or "matroska" in container.format.name:
        return None
    entries = [entry for entry in stream.index_entries if entry.size > 0]
    if len(entries) != stream.frames or not all(entry.is_keyframe and not entry.is_discard for entry in entries):
        return None
    stamps = [entry.timestamp for entry in entries]
    first = next((packet.pts for packet in container.demux(stream) if packet.size), None)
    container.seek(stamps[0], stream=stream)
    return VideoIndex(stamps, stamps) if first == stamps[0] and _increases(stamps) else None


def _walked(container: InputContainer, stream: VideoStream) -> VideoIndex:
    """From all packets in the file. Frames may be stored in another order than shown; their stamps tell."""
    stamps: list[int | None] = []
    key_stamps = []
    for packet in container.demux(stream):
        if not packet.size or packet.is_discard or not _is_shown(packet, stream):
            continue
        if len(stamps) >= MAX_FRAMES:
            raise ValueError(f"it has more than {MAX_FRAMES:,} frames")
        stamps.append(packet.pts)
        if packet.is_keyframe and packet.pts is not None:
            key_stamps.append(packet.pts)
    known = sorted(stamp for stamp in stamps if stamp is not None)
    stands_alone = len(key_stamps) == len(stamps)
    # AVI has no stamps of showing: where frames depend on each other, what FFmpeg makes up may be another order.
    if len(known) == len(stamps) and _increases(known) and (stands_alone or container.format.name != "avi"):
        return VideoIndex(known, sorted(key_stamps))
    return VideoIndex(list(range(len(stamps))), is_by_count=True)


def _increases(stamps: Iterable[int]) -> bool:
    return all(a < b for a, b in pairwise(stamps))


def _is_shown(packet: "Packet[VideoStream]", stream: VideoStream) -> bool:
    """VP8 keeps frames that are never shown in packets of their own (RFC 6386, 9.1)."""
    return stream.codec_context.name != "vp8" or bool(bytes(packet)[0] & 0x10)
