"""A ZIP archive as named files. Nothing is ever unpacked to a disk, and nothing larger than a frame into memory."""

import io
import stat
import threading
import zipfile
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import BinaryIO, cast

from dropflow.errors import FramesError
from dropflow.frames.damage import Source, reading

_MAX_MEMBER_BYTES = 2**30
_MAX_MEMBERS = 1_000_000
_COMPRESSIONS = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
_IN_MEMORY_BYTES = 2**26
"""A file that is stored as it is and larger than this is read by ranges, without the archive's checksum of it."""
_LOCAL_HEADER_BYTES = 30
_LOCAL_MAGIC = b"PK\x03\x04"


class ZipFiles:
    """The files inside a ZIP archive, whose names must be those of files inside it."""

    def __init__(self, archive: BinaryIO, *, label: str) -> None:
        self._label = label
        self._source = Source(archive)
        self._lock = threading.RLock()
        try:
            with reading("ZIP archive", file=label, source=self._source):
                self._zip = zipfile.ZipFile(self._source.as_file())
                self._members = self._checked_members()
        except BaseException:
            archive.close()
            raise

    def close(self) -> None:
        self._zip.close()
        self._source.close()

    def names(self) -> Sequence[str]:
        return list(self._members)

    def open(self, name: str) -> BinaryIO:
        info = self._members[name]
        is_plain = info.compress_type == zipfile.ZIP_STORED and not info.flag_bits & 1
        with self._lock, reading("file in the ZIP archive", file=self._inside(name), source=self._source):
            if is_plain and info.file_size > _IN_MEMORY_BYTES:
                return self._range(info)
            return self._unpacked(info, name)

    def _checked_members(self) -> dict[str, zipfile.ZipInfo]:
        if len(self._zip.filelist) > _MAX_MEMBERS:
            raise FramesError(
                f"The ZIP archive holds more than {_MAX_MEMBERS} files.", code="frames.too_large", file=self._label
            )
        members: dict[str, zipfile.ZipInfo] = {}
        for info in self._zip.filelist:
            name = info.filename.replace("\\", "/")  # as some programs on Windows write it
            if info.is_dir() or name.endswith("/"):
                continue
            self._check_name(name, info)
            if name in members:
                raise self._unsafe(name, "is there twice")
            members[name] = info
        return members

    def _check_name(self, name: str, info: zipfile.ZipInfo) -> None:
        path = PurePosixPath(name)
        if path.is_absolute() or name[1:2] == ":":
            raise self._unsafe(name, "has an absolute name")
        if ".." in path.parts:
            raise self._unsafe(name, "lies outside the archive")
        if stat.S_ISLNK(info.external_attr >> 16):
            raise self._unsafe(name, "is a link")

    def _unsafe(self, name: str, reason: str) -> FramesError:
        return FramesError(
            f"The ZIP archive is refused: {name!r} in it {reason}.",
            code="frames.unsafe_archive",
            file=self._label,
            hint="Pack the folder of frames again.",
        )

    def _inside(self, name: str) -> str:
        return f"{self._label}, {name}"

    def _unpacked(self, info: zipfile.ZipInfo, name: str) -> BinaryIO:
        if info.file_size > _MAX_MEMBER_BYTES:
            raise FramesError(
                f"The file would unpack to {info.file_size:,} bytes; {_MAX_MEMBER_BYTES:,} is the most.",
                code="frames.too_large",
                file=self._inside(name),
                hint="Pack large files without compression (zip -0), or give them as they are.",
            )
        if info.compress_type not in _COMPRESSIONS:
            raise FramesError(
                "Its compression is not read.",
                code="frames.unsupported",
                file=self._inside(name),
                hint="Pack the archive with deflate, or without compression.",
            )
        with self._zip.open(info) as member:
            # One byte more than it says: zipfile inflates as far as it is asked, whatever was said.
            return io.BytesIO(member.read(info.file_size + 1))

    def _range(self, info: zipfile.ZipInfo) -> BinaryIO:
        self._source.seek(info.header_offset)
        header = self._source.read(_LOCAL_HEADER_BYTES)
        if len(header) < _LOCAL_HEADER_BYTES or header[:4] != _LOCAL_MAGIC:
            raise ValueError("a file in it does not begin where it should")
        n_name, n_extra = (int.from_bytes(header[at : at + 2], "little") for at in (26, 28))
        start = info.header_offset + _LOCAL_HEADER_BYTES + n_name + n_extra
        if start + info.file_size > self._source.size_bytes:
            raise ValueError("it ends within a file")
        return cast(BinaryIO, io.BufferedReader(_Range(self._source, self._lock, start, info.file_size)))


class _Range(io.RawIOBase):
    """Part of a file that others read, too."""

    def __init__(self, source: Source, lock: threading.RLock, start: int, size_bytes: int) -> None:
        self._source, self._lock, self._start, self._size_bytes = source, lock, start, size_bytes
        self._at = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        self._at = max(0, offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self._size_bytes}[whence])
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        n_wanted = max(0, min(len(buffer), self._size_bytes - self._at))
        with self._lock:
            self._source.seek(self._start + self._at)
            content = self._source.read(n_wanted)
        buffer[: len(content)] = content
        self._at += len(content)
        return len(content)
