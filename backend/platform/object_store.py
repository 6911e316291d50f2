"""Bytes by key, in a local folder or in S3. Keys are made here of ids; no name from outside becomes one."""

import os
import shutil
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import suppress
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote, urlparse
from uuid import UUID

import obstore
import zarr.storage
from obstore.store import LocalStore, from_url

from backend.models.lifecycle import OUTSIDE
from backend.platform.growing import Growing, GrowingFile, GrowingPieces
from backend.platform.imported import Imported
from backend.platform.places import INDEX_NAME, READ_BYTES, Piece, Place, ReadAt, buffered, joined, read_index

_MOST_INDEXES = 1000
QUALITY_FILE, QUALITY_BY_RADIUS_FILE = "quality.bin", "quality_by_radius.bin"
"""Beside what tracking made: `FrameQuality` and `QualityByRadius` of `dropflow.statistics.quality`, packed."""


def file_key(experiment_id: UUID, file_id: UUID) -> str:
    """Where an uploaded file is kept."""
    return f"{experiment_prefix(experiment_id)}files/{file_id}"


def upload_key(experiment_id: UUID, upload_id: UUID, *, can_grow: bool) -> str:
    """Where the bytes of an upload are kept: in one object if objects can grow, else in pieces below a prefix."""
    return file_key(experiment_id, upload_id) + ("" if can_grow else "/")


def product_prefix(experiment_id: UUID, shard_id: UUID, fence: int) -> str:
    """Where one holder of a shard writes: a later holder has a later fence, so neither meets the other."""
    return f"{experiment_prefix(experiment_id)}products/{shard_id}/{fence}/"


def experiment_prefix(experiment_id: UUID) -> str:
    """Everything of an experiment lies below this."""
    return f"experiments/{experiment_id}/"


class ObjectStore:
    """The few things done with objects, the same for every kind of store."""

    def __init__(self, url: str, outside: Mapping[str, str] | None = None) -> None:
        self.imported = Imported(outside or {})
        """Files that stay where they were imported from; `outside` are the roots they lie below, by name."""
        self._root: Path | None = None
        if url.startswith("file://"):
            self._root = Path(unquote(urlparse(url).path))
            self._root.mkdir(parents=True, exist_ok=True)
            self.store: obstore.store.ObjectStore = LocalStore(self._root, automatic_cleanup=True)
        else:
            self.store = from_url(url)
        self.url = url
        self._indexes: dict[str, list[Piece]] = {}

    async def put_stream(self, key: str, chunks: AsyncIterator[bytes]) -> None:
        """Write `chunks` as they come; if they end in an error, nothing is left."""
        await obstore.put_async(self.store, key, chunks)

    def put(self, key: str, content: bytes | Path) -> None:
        """Write an object at once."""
        obstore.put(self.store, key, content)

    def read(self, key: str) -> bytes:
        """The whole of a small object."""
        return bytes(obstore.get(self.store, key).bytes())

    def stream(self, key: str, start: int = 0, stop: int | None = None) -> Iterator[bytes]:
        """An object, or its bytes from `start` until before `stop`, piece by piece."""
        if stop is not None and stop <= start:
            return
        found = obstore.get(self.store, key, options=None if stop is None else {"range": (start, stop)})
        for chunk in found.stream(min_chunk_size=READ_BYTES):
            yield bytes(chunk)

    def open(self, key: str) -> BinaryIO:
        """Open an object for reading; it can seek."""
        if self._root is not None:
            return (self._root / key).open("rb")
        return self.open_place(Place(key, 0, obstore.head(self.store, key)["size"]))

    def open_place(self, place: Place) -> BinaryIO:
        """Open a stretch of an object, or of pieces, for reading; it can seek."""
        close = None
        if place.key.startswith(OUTSIDE):
            return self.imported.open(place)
        if place.key.endswith("/"):
            read_at = joined(self._pieces(place.key), lambda name, at, n: self._range(place.key + name, at, n))
        elif self._root is None:
            read_at = partial(self._range, place.key)
        else:
            file = (self._root / place.key).open("rb")
            if place.start_byte == 0 and os.fstat(file.fileno()).st_size == place.size_bytes:
                return file
            read_at, close = _reading(file), file.close
        return buffered(read_at, start=place.start_byte, size=place.size_bytes, close=close)

    def stream_place(self, place: Place, start: int, stop: int) -> Iterator[bytes]:
        """The bytes from `start` until before `stop` of a stretch, piece by piece."""
        with self.open_place(place) as file:
            file.seek(start)
            while start < stop and (piece := file.read(min(READ_BYTES, stop - start))):
                start += len(piece)
                yield piece

    @property
    def can_grow(self) -> bool:
        """Whether an object can be appended to."""
        return self._root is not None

    def grow(self, key: str, *, at_byte: int, fence: int) -> Growing:
        """Open what `upload_key` names for appending after byte `at_byte`."""
        if self._root is not None:
            return GrowingFile(self._root / key, at_byte)
        return GrowingPieces(self.store, key, at_byte, fence)

    def free_bytes(self) -> int | None:
        """How much more can be kept; None where nobody can tell."""
        return None if self._root is None else shutil.disk_usage(self._root).free

    def _range(self, key: str, start: int, n: int) -> bytes:
        return bytes(obstore.get_range(self.store, key, start=start, end=start + n))

    def _pieces(self, prefix: str) -> list[Piece]:
        """The index of an upload's pieces: it never changes once it is there."""
        if prefix not in self._indexes:
            if len(self._indexes) >= _MOST_INDEXES:
                self._indexes.clear()
            self._indexes[prefix] = read_index(self.read(prefix + INDEX_NAME))
        return self._indexes[prefix]

    def as_folder(self, prefix: str, scratch: Path) -> Path:
        """The objects below `prefix` as files: where they are if that is a folder, else copied into `scratch`."""
        if self._root is not None:
            return self._root / prefix
        for key, _ in self.list(prefix):
            target = scratch / key.removeprefix(prefix)
            target.parent.mkdir(parents=True, exist_ok=True)
            with self.open(key) as source, target.open("wb") as copy:
                shutil.copyfileobj(source, copy, READ_BYTES)
        return scratch

    def answers(self) -> None:
        """Raise what the store raises if it cannot be reached."""
        if self._root is not None and not self._root.is_dir():
            raise FileNotFoundError(self._root)
        with suppress(FileNotFoundError):
            obstore.head(self.store, "nothing")

    def list(self, prefix: str) -> list[tuple[str, int]]:
        """Keys below `prefix` with their sizes, sorted."""
        found = [(meta["path"], meta["size"]) for page in obstore.list(self.store, prefix) for meta in page]
        return sorted(found)

    def older_than(self, prefix: str, moment: datetime) -> Iterator[str]:
        """Keys below `prefix` that were last written before `moment`."""
        for page in obstore.list(self.store, prefix):
            for meta in page:
                if meta["last_modified"] < moment:
                    yield meta["path"]

    def remove_leftovers(self, moment: datetime) -> None:
        """Remove what writes that broke off before `moment` left beside the objects; only folders have that."""
        for path in self._root.rglob("*#*") if self._root is not None else ():
            if path.is_file() and path.stat().st_mtime < moment.timestamp():
                path.unlink(missing_ok=True)

    def zarr_store(self, prefix: str) -> zarr.storage.ObjectStore[Any]:
        """The objects below `prefix` as an array store to read from."""
        store = from_url(f"{self.url.rstrip('/')}/{prefix}") if self._root is None else LocalStore(self._root / prefix)
        return zarr.storage.ObjectStore(store, read_only=True)

    def remove(self, key: str) -> None:
        """Remove an object, or all below a prefix that ends in ``/``; what is not there is no error."""
        keys = [found for found, _ in self.list(key)] if key.endswith("/") else [key]
        for start in range(0, len(keys), 1000):
            try:
                obstore.delete(self.store, keys[start : start + 1000])
            except FileNotFoundError:
                continue


def _reading(file: BinaryIO) -> ReadAt:
    def read_at(start: int, n: int) -> bytes:
        return os.pread(file.fileno(), n, start)

    return read_at
