"""Bytes by key, in a local folder or in S3. Keys are made here of ids; no name from outside becomes one."""

import io
import shutil
from collections.abc import AsyncIterator, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, cast
from urllib.parse import unquote, urlparse
from uuid import UUID

import obstore
import zarr.storage
from obstore.store import LocalStore, from_url

READ_BYTES = 1 << 20


def file_key(experiment_id: UUID, file_id: UUID) -> str:
    """Where an uploaded file is kept."""
    return f"{experiment_prefix(experiment_id)}files/{file_id}"


def product_prefix(experiment_id: UUID, shard_id: UUID, fence: int) -> str:
    """Where one holder of a shard writes: a later holder has a later fence, so neither meets the other."""
    return f"{experiment_prefix(experiment_id)}products/{shard_id}/{fence}/"


def experiment_prefix(experiment_id: UUID) -> str:
    """Everything of an experiment lies below this."""
    return f"experiments/{experiment_id}/"


class ObjectStore:
    """The few things done with objects, the same for every kind of store."""

    def __init__(self, url: str) -> None:
        self._root: Path | None = None
        if url.startswith("file://"):
            self._root = Path(unquote(urlparse(url).path))
            self._root.mkdir(parents=True, exist_ok=True)
            self.store: obstore.store.ObjectStore = LocalStore(self._root, automatic_cleanup=True)
        else:
            self.store = from_url(url)
        self._url = url

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
        return cast(BinaryIO, io.BufferedReader(_RangeReader(self.store, key), READ_BYTES))

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

    def zarr_store(self, prefix: str) -> zarr.storage.ObjectStore[Any]:
        """The objects below `prefix` as an array store to read from."""
        store = from_url(f"{self._url.rstrip('/')}/{prefix}") if self._root is None else LocalStore(self._root / prefix)
        return zarr.storage.ObjectStore(store, read_only=True)

    def remove(self, key: str) -> None:
        """Remove an object, or all below a prefix that ends in ``/``; what is not there is no error."""
        keys = [found for found, _ in self.list(key)] if key.endswith("/") else [key]
        for start in range(0, len(keys), 1000):
            try:
                obstore.delete(self.store, keys[start : start + 1000])
            except FileNotFoundError:
                continue


class _RangeReader(io.RawIOBase):
    """A remote object as a file: each read is a range request."""

    def __init__(self, store: obstore.store.ObjectStore, key: str) -> None:
        self._store, self._key, self._at = store, key, 0
        self._size = obstore.head(store, key)["size"]

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
        end = min(self._at + len(buffer), self._size)
        if end <= self._at:
            return 0
        content = obstore.get_range(self._store, self._key, start=self._at, end=end)
        buffer[: len(content)] = memoryview(content)
        self._at += len(content)
        return len(content)
