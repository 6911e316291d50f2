"""Where the bytes of a file are, and reading them there: a stretch of an object, or of many pieces of one."""

import io
import json
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import BinaryIO, cast

INDEX_NAME = "pieces.json"
"""Beside the pieces of an upload: their names and sizes, in the order of their bytes."""

READ_BYTES = 1 << 20

ReadAt = Callable[[int, int], bytes]
"""`read_at(start, n)` gives at most `n` bytes, and none only at the end."""


@dataclass(frozen=True)
class Place:
    """Some bytes of the object `key`; below it, if it ends in ``/``, are pieces and their index."""

    key: str
    start_byte: int
    size_bytes: int
    version: str | None = None
    """Of a file outside the store, as it was when it was imported."""
    sha256: str | None = None
    """Of a file outside the store."""


@dataclass(frozen=True)
class Piece:
    """Bytes of something large in an object of their own."""

    name: str
    size_bytes: int


class Stretch(io.RawIOBase):
    """A stretch of something that can be read at any place, as a file."""

    def __init__(self, read_at: ReadAt, *, start: int, size: int, close: Callable[[], None] | None = None) -> None:
        self._read_at, self._start, self._size, self._at = read_at, start, size, 0
        self._close = close

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._size}[whence]
        self._at = max(0, start + offset)
        return self._at

    def tell(self) -> int:
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        n_wanted = min(len(buffer), self._size - self._at)
        if n_wanted <= 0:
            return 0
        content = self._read_at(self._start + self._at, n_wanted)
        buffer[: len(content)] = memoryview(content)
        self._at += len(content)
        return len(content)

    def close(self) -> None:
        if not self.closed and self._close is not None:
            self._close()
        super().close()


def buffered(read_at: ReadAt, *, size: int, start: int = 0, close: Callable[[], None] | None = None) -> BinaryIO:
    """Something that can be read at any place, as a file whose small reads are joined."""
    return cast(BinaryIO, io.BufferedReader(Stretch(read_at, start=start, size=size, close=close), READ_BYTES))


def joined(pieces: Sequence[Piece], read_piece: Callable[[str, int, int], bytes]) -> ReadAt:
    """Pieces as one: `read_piece(name, start, n)` reads in one of them."""
    ends = list(accumulate(piece.size_bytes for piece in pieces))

    def read_at(start: int, n: int) -> bytes:
        number = bisect_right(ends, start)
        if number == len(pieces):
            return b""
        piece = pieces[number]
        inside = start - (ends[number] - piece.size_bytes)
        return read_piece(piece.name, inside, min(n, piece.size_bytes - inside))

    return read_at


def write_index(pieces: Sequence[Piece]) -> bytes:
    """The index of `pieces`, to be kept beside them."""
    return json.dumps([[piece.name, piece.size_bytes] for piece in pieces]).encode()


def read_index(content: bytes) -> list[Piece]:
    """What `write_index` wrote."""
    return [Piece(name, size_bytes) for name, size_bytes in json.loads(content)]
