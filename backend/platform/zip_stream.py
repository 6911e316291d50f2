"""A folder of the object store as a ZIP archive on the fly: nothing is held but the piece on its way."""

import io
import zipfile
from collections.abc import Iterable, Iterator

# The same bytes for the same content, whenever it is asked for.
_DATE = (1980, 1, 1, 0, 0, 0)
_PER_MEMBER_BYTES = 30 + 46 + 16  # local header, central entry, data descriptor
_END_BYTES = 22


def stored_zip_bytes(members: Iterable[tuple[str, int]]) -> int:
    """Exact size of the archive `zip_stream` makes of members (name, size); ZIP64 is never needed for these."""
    return _END_BYTES + sum(_PER_MEMBER_BYTES + 2 * len(name.encode()) + size for name, size in members)


def zip_stream(members: Iterable[tuple[str, bytes]]) -> Iterator[bytes]:
    """The archive, piece by piece, members uncompressed: their content is compressed already."""
    sink = _Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED, allowZip64=False) as archive:
        for name, content in members:
            with archive.open(zipfile.ZipInfo(name, _DATE), "w") as member:
                member.write(content)
            yield sink.take()
    yield sink.take()


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
