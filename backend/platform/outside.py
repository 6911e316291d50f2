"""Folders of the server and prefixes of S3 that frames may be imported from: those an administrator lists, no others.

Nobody gives an address: people name a root of the list and a path below it. In a folder every step of the path is
opened below the one before it and no link is followed, so nothing that somebody puts there leads out of it.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, BinaryIO, Protocol
from urllib.parse import unquote, urlparse

import obstore
from obstore.exceptions import BaseError
from obstore.store import from_url

from backend.platform.places import buffered
from backend.platform.texts import is_storable
from dropflow.errors import FramesError

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
# A pipe that nobody writes to must not keep us waiting.
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK
MAX_ENTRIES = 1_000_000
"""A folder with more files is refused."""


@dataclass(frozen=True)
class OutsideFile:
    """A file as it was when it was looked at."""

    name: str
    """Below the folder that was listed, ``/`` between folders."""
    size_bytes: int
    version: str
    """Differs when the file was written since."""


@dataclass(frozen=True)
class Listing:
    """What is in a folder."""

    folders: tuple[str, ...]
    files: tuple[OutsideFile, ...]


class Root(Protocol):
    """A place on the list. Paths are relative, ``/`` between folders; `FramesError` where nothing usable is there."""

    def listing(self, path: str) -> Listing:
        """What is directly in a folder."""
        ...

    def look(self, path: str) -> OutsideFile | None:
        """A file, named by its last part; None where there is none of this path."""
        ...

    def open(self, path: str) -> tuple[BinaryIO, OutsideFile]:
        """Open a file for reading, and what it is now."""
        ...


def make_root(url: str) -> Root:
    """The place that a URL of the settings names."""
    if url.startswith("file://"):
        return FolderRoot(Path(unquote(urlparse(url).path)))
    return StoreRoot(from_url(url))


def deep_listing(root: Root, path: str) -> Iterator[OutsideFile]:
    """All files below a folder, named from there."""
    folders = [""]
    n_found = 0
    while folders:
        folder = folders.pop()
        found = root.listing("/".join(part for part in (path, folder) if part))
        folders += [f"{folder}/{name}" if folder else name for name in found.folders]
        for file in found.files:
            n_found += 1
            _check_count(n_found, path)
            yield OutsideFile(f"{folder}/{file.name}" if folder else file.name, file.size_bytes, file.version)


def checked_path(path: str) -> str:
    """The path if it stays below its root, without a ``/`` at its end; refused otherwise."""
    path = path.removesuffix("/")
    parts = path.split("/") if path else []
    is_clean = all(part not in ("", ".", "..") for part in parts) and "\\" not in path and len(path) <= 1000
    if not is_clean or not is_storable(path) or any(ord(character) < 32 for character in path):
        raise FramesError(
            "This is no path below the root.",
            code="frames.bad_path",
            hint="Give folders with / between them, such as 2024/run 1, without .. and without / at the beginning.",
        )
    return path


class FolderRoot:
    """A folder of this machine."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def listing(self, path: str) -> Listing:
        folders, files = [], []
        with self._opened(path, _FOLDER) as descriptor, os.scandir(descriptor) as entries:
            for entry in entries:
                with suppress(OSError):  # it went away while we looked
                    about = entry.stat(follow_symlinks=False)
                    if stat.S_ISDIR(about.st_mode):
                        folders.append(entry.name)
                    elif stat.S_ISREG(about.st_mode) and is_storable(entry.name):
                        files.append(_as_found(entry.name, about))
                _check_count(len(files), path)
        return Listing(tuple(sorted(folders)), tuple(sorted(files, key=lambda file: file.name)))

    def look(self, path: str) -> OutsideFile | None:
        try:
            file, found = self.open(path)
        except FramesError:
            return None
        file.close()
        return found

    def open(self, path: str) -> tuple[BinaryIO, OutsideFile]:
        with self._opened(path, _FILE) as descriptor:
            about = os.fstat(descriptor)
            if not stat.S_ISREG(about.st_mode):
                raise _not_there(path)
            return os.fdopen(os.dup(descriptor), "rb"), _as_found(PurePosixPath(path).name, about)

    @contextmanager
    def _opened(self, path: str, flags: int) -> Iterator[int]:
        """A file or folder below the root, opened step by step."""
        parts = [part for part in checked_path(path).split("/") if part]
        try:
            descriptor = os.open(self._folder, _FOLDER & ~os.O_NOFOLLOW)
            try:
                for number, part in enumerate(parts, start=1):
                    below = os.open(part, flags if number == len(parts) else _FOLDER, dir_fd=descriptor)
                    os.close(descriptor)
                    descriptor = below
            except BaseException:
                os.close(descriptor)
                raise
        except OSError:
            raise _not_there(path) from None
        try:
            yield descriptor
        finally:
            os.close(descriptor)


class StoreRoot:
    """A prefix of an S3 store."""

    def __init__(self, store: obstore.store.ObjectStore) -> None:
        self._store = store

    def listing(self, path: str) -> Listing:
        prefix = checked_path(path)
        with _reaching(path):
            found = obstore.list_with_delimiter(self._store, f"{prefix}/" if prefix else None)
        below = len(prefix) + 1 if prefix else 0
        files = [_as_object(meta["path"][below:], meta) for meta in found["objects"] if meta["path"][below:]]
        _check_count(len(files), path)
        folders = sorted(name[below:].rstrip("/") for name in found["common_prefixes"])
        if not files and not folders and prefix:
            raise _not_there(path)
        return Listing(tuple(folders), tuple(sorted(files, key=lambda file: file.name)))

    def look(self, path: str) -> OutsideFile | None:
        try:
            with _reaching(path):
                return _as_object(PurePosixPath(path).name, obstore.head(self._store, checked_path(path)))
        except FramesError as problem:
            if problem.code != "frames.not_found":
                raise
            return None

    def open(self, path: str) -> tuple[BinaryIO, OutsideFile]:
        found = self.look(path)
        if found is None:
            raise _not_there(path)
        return buffered(partial(self._range, checked_path(path)), size=found.size_bytes), found

    def _range(self, key: str, start: int, n: int) -> bytes:
        with _reaching(key):
            return bytes(obstore.get_range(self._store, key, start=start, end=start + n))


@contextmanager
def _reaching(path: str) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise _not_there(path) from None
    except BaseError:
        raise OSError(f"the store of {path or 'the root'} cannot be reached") from None


def _as_found(name: str, about: os.stat_result) -> OutsideFile:
    return OutsideFile(name, about.st_size, f"{about.st_size}-{about.st_mtime_ns}")


def _as_object(name: str, meta: Any) -> OutsideFile:
    return OutsideFile(name, meta["size"], str(meta["e_tag"] or meta["last_modified"].isoformat()).strip('"')[:100])


def _check_count(n_files: int, path: str) -> None:
    if n_files > MAX_ENTRIES:
        raise FramesError(f"More than {MAX_ENTRIES:,} files lie here.", code="frames.too_large", file=path)


def _not_there(path: str) -> FramesError:
    return FramesError(
        "There is no such file or folder, or it cannot be read.",
        code="frames.not_found",
        file=path or None,
        hint="Links are not followed, and the service must be allowed to read it.",
    )
