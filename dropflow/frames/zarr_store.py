"""Files of any kind as a Zarr store to read from."""

import asyncio
import io
import json
from collections.abc import AsyncIterator, Iterable, Sequence
from pathlib import PurePosixPath
from typing import Protocol

from zarr.abc.store import ByteRequest, OffsetByteRequest, RangeByteRequest, Store, SuffixByteRequest
from zarr.core.buffer import Buffer, BufferPrototype

from dropflow.errors import FramesError
from dropflow.frames.contract import Files
from dropflow.frames.zarr_blocks import Blocks

METADATA = frozenset({"zarr.json", ".zarray", ".zgroup", ".zattrs", ".zmetadata"})
_MAX_METADATA_BYTES = 2**26
_MAX_CHUNK_FILE_BYTES = 2**30


def zarr_roots(names: Iterable[str]) -> list[str]:
    """The folders in which Zarr arrays or groups begin; ``""`` for the files themselves being one."""
    folders = {str(path.parent) for path in map(PurePosixPath, names) if path.name in METADATA}
    outermost = {folder for folder in folders if not any(str(p) in folders for p in PurePosixPath(folder).parents)}
    return sorted("" if folder == "." else folder for folder in outermost)


class _Closeable(Protocol):
    def close(self) -> None: ...


class FilesStore(Store):
    """The files below `root`. Only names that are there are ever opened, whatever the metadata says."""

    supports_writes = False
    supports_deletes = False
    supports_listing = True

    def __init__(self, files: Files, root: str, *, owned: _Closeable | None = None) -> None:
        super().__init__(read_only=True)
        prefix = f"{root}/" if root else ""
        self._files, self._owned = files, owned
        self._name_of = {name.removeprefix(prefix): name for name in files.names() if name.startswith(prefix)}
        self.failure: Exception | None = None
        self.blocks: Blocks | None = None
        """How the blocks of the array that is read are packed; known when it is open."""

    @property
    def keys(self) -> Sequence[str]:
        """Every key there is."""
        return list(self._name_of)

    def json(self, key: str) -> dict[str, object]:
        """A document of metadata, empty if it is not there."""
        if key not in self._name_of:
            return {}
        found = json.loads(self._read(key, None))
        return found if isinstance(found, dict) else {}

    async def get(self, key: str, prototype: BufferPrototype, byte_range: ByteRequest | None = None) -> Buffer | None:
        if key not in self._name_of:
            return None
        return prototype.buffer.from_bytes(await asyncio.to_thread(self._read, key, byte_range))

    async def get_partial_values(
        self, prototype: BufferPrototype, key_ranges: Iterable[tuple[str, ByteRequest | None]]
    ) -> list[Buffer | None]:
        return [await self.get(key, prototype, byte_range) for key, byte_range in key_ranges]

    async def exists(self, key: str) -> bool:
        return key in self._name_of

    async def list(self) -> AsyncIterator[str]:
        for key in self._name_of:
            yield key

    async def list_prefix(self, prefix: str) -> AsyncIterator[str]:
        for key in self._name_of:
            if key.startswith(prefix):
                yield key

    async def list_dir(self, prefix: str) -> AsyncIterator[str]:
        inside = f"{prefix.rstrip('/')}/" if prefix else ""
        for part in {key[len(inside) :].split("/", 1)[0] for key in self._name_of if key.startswith(inside)}:
            yield part

    async def set(self, key: str, value: Buffer) -> None:  # noqa: ARG002
        raise PermissionError("frames are never written")

    async def delete(self, key: str) -> None:  # noqa: ARG002
        raise PermissionError("frames are never written")

    def close(self) -> None:
        super().close()
        if self._owned is not None:
            self._owned.close()

    def __eq__(self, other: object) -> bool:
        return self is other

    __hash__ = Store.__hash__

    def _read(self, key: str, byte_range: ByteRequest | None) -> bytes:
        is_metadata = PurePosixPath(key).name in METADATA
        most = _MAX_METADATA_BYTES if is_metadata else _MAX_CHUNK_FILE_BYTES
        try:
            with self._files.open(self._name_of[key]) as file:
                start, stop = _bounds(byte_range, file.seek(0, io.SEEK_END))
                file.seek(start)
                content = file.read(min(stop - start, most + 1))
        except FramesError:
            raise
        except Exception as problem:
            self.failure = problem
            raise
        if len(content) > most:
            raise ValueError(f"{key} is larger than {most:,} bytes")
        if self.blocks is not None and not is_metadata:
            self.blocks.check(content, byte_range)
        return content


def _bounds(wanted: ByteRequest | None, size_bytes: int) -> tuple[int, int]:
    match wanted:
        case RangeByteRequest(start, end):
            return min(start, size_bytes), min(end, size_bytes)
        case OffsetByteRequest(offset):
            return min(offset, size_bytes), size_bytes
        case SuffixByteRequest(suffix):
            return max(0, size_bytes - suffix), size_bytes
        case _:
            return 0, size_bytes
