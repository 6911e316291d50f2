"""Objects that grow while they are uploaded, in a store of either kind.

In a folder that is one file, which is appended to; S3 has no such thing, so there it is pieces of some megabytes, and
those that count are listed in the database until all are there. Either way a byte counts only once `sync` returned
and the caller has written that down; what comes after the last such byte is written over, or swept.
"""

import fcntl
import os
import time
from contextlib import suppress
from pathlib import Path
from typing import Protocol

import obstore

from backend.platform.places import Piece

_LOCK_WAIT_S = 5.0
_WRITE_BACK_BYTES = 1 << 22


class StillHeld(Exception):
    """An earlier sender has the file and has not noticed yet that it is no longer wanted."""


class Growing(Protocol):
    """An object open for appending."""

    sync_bytes: int
    """After so many bytes `sync` is worth its cost."""
    sync_s: float
    """After so many seconds it is."""

    def write(self, content: bytes) -> None:
        """Append; may raise `OSError` or obstore's errors."""

    def sync(self) -> list[Piece]:
        """Make all that was written safe. Returns the pieces this made."""

    def close(self) -> None:
        """Let go of it; what is not safe is lost."""


class GrowingFile:
    """A file that is appended to, by one process at a time."""

    sync_bytes, sync_s = 1 << 25, 1.0

    def __init__(self, path: Path, at_byte: int) -> None:
        is_new = not path.exists()
        path.parent.mkdir(parents=True, exist_ok=True)
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            self._lock()
            if os.fstat(self._descriptor).st_size < at_byte:
                raise OSError(f"{path} has lost bytes that were safe")
            os.ftruncate(self._descriptor, at_byte)
            os.lseek(self._descriptor, at_byte, os.SEEK_SET)
            self._at = self._begun = at_byte
            if is_new:
                _sync_folder(path.parent)
        except BaseException:
            self.close()
            raise

    def write(self, content: bytes) -> None:
        """Append all of it."""
        left = memoryview(content)
        while left:
            left = left[os.write(self._descriptor, left) :]
        self._at += len(content)
        if self._at - self._begun >= _WRITE_BACK_BYTES:
            self._begin_write_back()

    def sync(self) -> list[Piece]:
        """Have the disk keep it, whatever happens to the machine."""
        os.fdatasync(self._descriptor) if hasattr(os, "fdatasync") else os.fsync(self._descriptor)
        return []

    def close(self) -> None:
        """Let go of the lock, too."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def _begin_write_back(self) -> None:
        """Have the disk begin while more comes, so that `sync` waits half as long; nothing is dropped before."""
        if hasattr(os, "posix_fadvise"):
            with suppress(OSError):
                os.posix_fadvise(self._descriptor, self._begun, self._at - self._begun, os.POSIX_FADV_DONTNEED)
        self._begun = self._at

    def _lock(self) -> None:
        deadline = time.monotonic() + _LOCK_WAIT_S
        while True:
            try:
                fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            except BlockingIOError:
                if time.monotonic() > deadline:
                    raise StillHeld from None
                time.sleep(0.05)


class GrowingPieces:
    """Pieces below a prefix, each an object that is written at once. Their names tell senders apart."""

    sync_bytes, sync_s = 1 << 24, 10.0

    def __init__(self, store: obstore.store.ObjectStore, prefix: str, at_byte: int, fence: int) -> None:
        self._store, self._prefix, self._at, self._fence = store, prefix, at_byte, fence
        self._buffer = bytearray()
        self._made: list[Piece] = []

    def write(self, content: bytes) -> None:
        """Keep it until there is enough for a piece."""
        self._buffer += content
        if len(self._buffer) >= self.sync_bytes:
            self._put()

    def sync(self) -> list[Piece]:
        """Write what is kept as a piece, however small it is."""
        if self._buffer:
            self._put()
        made, self._made = self._made, []
        return made

    def close(self) -> None:
        """Forget what is kept."""
        self._buffer = bytearray()

    def _put(self) -> None:
        content = bytes(self._buffer)
        piece = Piece(f"{self._at:015d}-{self._fence}", len(content))
        obstore.put(self._store, self._prefix + piece.name, content, use_multipart=False)
        self._made.append(piece)
        self._at += len(content)
        self._buffer = bytearray()


def _sync_folder(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
