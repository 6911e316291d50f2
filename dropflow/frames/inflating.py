"""How large a compressed block becomes, before anything takes memory for it.

The libraries behind HDF5 and Zarr inflate until the block ends, and a hostile kilobyte can become a gigabyte.
"""

import bz2
import lzma
import zlib
from typing import Any, Protocol

import imagecodecs

_STEP_BYTES = 2**20
_ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"


def check_inflated(codec: str, content: bytes, most_bytes: int) -> None:
    """Raise `ValueError` if `content`, compressed with `codec`, is more than `most_bytes` or may be."""
    match codec:
        case "blosc":
            n_bytes = int.from_bytes(content[4:8], "little")
        case "lz4":
            n_bytes = int.from_bytes(content[:4], "little")
        case "zstd":
            n_bytes = _zstd_bytes(content, most_bytes)
        case "zlib":
            n_bytes = _counted(content, most_bytes, _Deflate, has_several=False)
        case "gzip":
            n_bytes = _counted(content, most_bytes, _Deflate)
        case "bz2":
            n_bytes = _counted(content, most_bytes, bz2.BZ2Decompressor)
        case "lzma":
            n_bytes = _counted(content, most_bytes, lzma.LZMADecompressor)
        case _:
            raise ValueError(f"it is compressed with {codec}")
    if n_bytes > most_bytes:
        raise ValueError(f"a block of {most_bytes:,} bytes inflates to more")


def _zstd_bytes(content: bytes, most_bytes: int) -> int:
    """As the frame's header says it (RFC 8878, 3.1.1.1), or by inflating into as much as there may be."""
    if content[:4] != _ZSTD_MAGIC or len(content) < 6:
        raise ValueError("a block is not compressed with zstd")
    flags = content[4]
    is_single = bool(flags & 0x20)
    n_size_bytes = (1 if is_single else 0, 2, 4, 8)[flags >> 6]
    if n_size_bytes == 0:
        return len(imagecodecs.zstd_decode(content, out=most_bytes))
    at = 5 + (not is_single) + (0, 1, 2, 4)[flags & 3]
    size = int.from_bytes(content[at : at + n_size_bytes], "little")
    return size + 256 if n_size_bytes == 2 else size


class _Inflating(Protocol):
    eof: bool
    unused_data: bytes

    def decompress(self, content: bytes, max_length: int) -> bytes: ...


class _Deflate:
    """zlib's decompressor with the manners of the others: what it was not asked for yet, it keeps."""

    def __init__(self) -> None:
        self._stream = zlib.decompressobj(wbits=47)  # zlib or gzip, as the header says
        self._waiting = b""

    def decompress(self, content: bytes, max_length: int) -> bytes:
        inflated = self._stream.decompress(self._waiting + content, max_length)
        self._waiting = self._stream.unconsumed_tail
        return inflated

    @property
    def eof(self) -> bool:
        return self._stream.eof

    @property
    def unused_data(self) -> bytes:
        return self._stream.unused_data


def _counted(content: bytes, most_bytes: int, start: Any, *, has_several: bool = True) -> int:
    """Bytes that inflate from `content`, streams one after the other, counted in steps to just beyond `most_bytes`."""
    n_bytes = 0
    while content and n_bytes <= most_bytes:
        stream: _Inflating = start()
        given = content
        while not stream.eof and n_bytes <= most_bytes:
            inflated = stream.decompress(given, _STEP_BYTES)
            if not inflated and not given:
                return n_bytes  # cut off, as whoever inflates it will say
            n_bytes += len(inflated)
            given = b""
        content = stream.unused_data if has_several else b""
    return n_bytes
