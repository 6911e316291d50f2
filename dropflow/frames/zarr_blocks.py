"""What a Zarr array's blocks are packed with, and whether one may be unpacked."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from zarr.abc.store import ByteRequest, RangeByteRequest

from dropflow.errors import FramesError
from dropflow.frames.inflating import check_inflated

_COMPRESSORS = {"blosc", "lz4", "zstd", "gzip", "zlib", "bz2", "lzma"}
_HARMLESS = {"bytes", "transpose", "delta", "shuffle", "bitround", "fixedscaleoffset"}
"""Others may run what they find in a block (pickle), or make of it what they like."""
_SHARDS, _CHECKSUM = "sharding_indexed", "crc32c"
_CHECKSUM_BYTES = 4
_NOTHING_THERE = 2**64 - 1


@dataclass(frozen=True)
class Blocks:
    """How the blocks of one array are packed."""

    n_bytes: int
    """Of one block, unpacked."""
    compressor: str | None
    has_checksum: bool
    """Whether four bytes of checksum follow what is compressed."""
    n_in_shard: int | None
    """Blocks in a file, if there are several."""

    def check(self, content: bytes, byte_range: ByteRequest | None) -> None:
        """Raise `ValueError` if what was read would unpack to more than a block."""
        if self.n_in_shard is None or isinstance(byte_range, RangeByteRequest):
            self._check_one(content)
        elif byte_range is None:
            for block in self._in_shard(content):
                self._check_one(block)

    def _check_one(self, content: bytes) -> None:
        packed = content[:-_CHECKSUM_BYTES] if self.has_checksum else content
        if self.compressor is None:
            if len(packed) > self.n_bytes:
                raise ValueError("a block is larger than it should be")
        else:
            check_inflated(self.compressor, packed, self.n_bytes)

    def _in_shard(self, content: bytes) -> Iterator[bytes]:
        """The blocks in a shard, as the index at its end says (offset and length, 8 bytes each, then a checksum)."""
        index = content[-(16 * (self.n_in_shard or 0) + _CHECKSUM_BYTES) : -_CHECKSUM_BYTES]
        numbers = [int.from_bytes(index[at : at + 8], "little") for at in range(0, len(index), 8)]
        for start, length in zip(numbers[::2], numbers[1::2], strict=True):
            if start != _NOTHING_THERE:
                yield content[start : start + length]


def blocks_of(metadata: Mapping[str, Any], block: Sequence[int], itemsize: int, label: str) -> Blocks:
    """Look at every codec of an array.

    Raises
    ------
    FramesError
        ``frames.unsupported`` naming those that are not read.
    """
    codecs = list(_codecs(metadata))
    names = [name for name, _ in codecs]
    n_in_shard = None
    if names == [_SHARDS]:
        about = codecs[0][1]
        inner = about["chunk_shape"]
        n_in_shard = prod(n // step for n, step in zip(block, inner, strict=True))
        index = [name for name, _ in _codecs({"codecs": about.get("index_codecs", ())})]
        names = [name for name, _ in _codecs({"codecs": about["codecs"]})]
        block = inner
        if index != ["bytes", _CHECKSUM] or about.get("index_location", "end") != "end":
            raise _unsupported(["shards with an index of another form"], label)
    has_checksum = names[-1:] == [_CHECKSUM]
    packed = names[:-1] if has_checksum else names
    compressor = packed[-1] if packed and packed[-1] in _COMPRESSORS else None
    unknown = sorted(set(packed[:-1] if compressor else packed) - _HARMLESS)
    if unknown:
        raise _unsupported(unknown, label)
    return Blocks(prod(block) * itemsize, compressor, has_checksum, n_in_shard)


def _codecs(metadata: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Name and settings of each codec, in the order of packing (Zarr 3: codecs; Zarr 2: filters, then compressor)."""
    old = [*(metadata.get("filters") or ()), metadata.get("compressor")]
    for codec in [*(metadata.get("codecs") or ()), *(codec for codec in old if codec)]:
        about = codec if isinstance(codec, dict) else codec.get_config()
        name = str(about.get("name") or about.get("id")).removeprefix("numcodecs.").lower()
        yield name, about.get("configuration") or {}


def _unsupported(what: Sequence[str], label: str) -> FramesError:
    return FramesError(
        f"Its packing ({', '.join(what)}) is not read.",
        code="frames.unsupported",
        file=label,
        hint="Store it with blosc, zstd, gzip, lz4, bz2 or lzma.",
    )
