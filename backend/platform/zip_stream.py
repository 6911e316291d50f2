"""A folder of the object store as a ZIP archive on the fly: nothing is held but the piece on its way."""

import io
import zipfile
from collections.abc import Iterable, Iterator

# The same bytes for the same content, whenever it is asked for.
_DATE = (1980, 1, 1, 0, 0, 0)
_LARGE = 1 << 31
"""A member of so many bytes has sizes that only the newer form of an archive (Zip64) can say."""


def zip_stream(members: Iterable[tuple[str, bytes]]) -> Iterator[bytes]:
    """The archive, piece by piece, members uncompressed: their content is compressed already."""
    sink = _Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED) as archive:
        for name, content in members:
            with archive.open(zipfile.ZipInfo(name, _DATE), "w", force_zip64=len(content) >= _LARGE) as member:
                member.write(content)
            yield sink.take()
    yield sink.take()


def part(pieces: Iterable[bytes], start: int, stop: int) -> Iterator[bytes]:
    """The bytes from `start` until before `stop` of what `pieces` come to."""
    at = 0
    for piece in pieces:
        if at >= stop:
            return
        if wanted := piece[max(0, start - at) : stop - at]:
            yield wanted
        at += len(piece)


class _Sink(io.RawIOBase):
    """A file that can only be written to, as a connection is."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, content: bytes) -> int:  # type: ignore[override]
        self._pieces.append(bytes(content))
        return len(content)

    def take(self) -> bytes:
        """What was written since the last time."""
        taken, self._pieces = b"".join(self._pieces), []
        return taken
