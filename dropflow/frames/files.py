"""Folders and ZIP archives as named files, and the order in which people number them."""

import io
import re
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from dropflow.errors import FramesError
from dropflow.frames.contract import MAX_FRAME_PIXELS

IMAGE_SUFFIXES = frozenset({".tif", ".tiff", ".png", ".jpg", ".jpeg"})
"""Which names are looked at as frames; the content then decides what they are."""

_MAX_MEMBER_BYTES = 8 * MAX_FRAME_PIXELS
_MAX_MEMBERS = 1_000_000


def natural_order(names: Iterable[str]) -> list[str]:
    """Sort names as people number them: ``frame2`` before ``frame10``."""
    return sorted(names, key=_natural_key)


def _natural_key(name: str) -> tuple[list[tuple[int, int | str]], str]:
    parts = re.split(r"(\d+)", name.casefold())
    return [(0, int(part)) if part.isdecimal() else (1, part) for part in parts], name


def image_names(names: Iterable[str]) -> list[str]:
    """Of `names`, those that are called like images, in natural order; what operating systems hide is left out."""
    seen = (PurePosixPath(name) for name in names)
    return natural_order(str(path) for path in seen if path.suffix.lower() in IMAGE_SUFFIXES and not _is_hidden(path))


def _is_hidden(path: PurePosixPath) -> bool:
    return any(part.startswith(".") or part == "__MACOSX" for part in path.parts)


class FolderFiles:
    """The files directly inside a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def names(self) -> Sequence[str]:
        return [entry.name for entry in self._folder.iterdir() if entry.is_file()]

    def open(self, name: str) -> BinaryIO:
        return (self._folder / name).open("rb")


class ZipFiles:
    """The files inside a ZIP archive. A member is bounded before it is unpacked, and unpacked into memory only."""

    def __init__(self, archive: BinaryIO, *, label: str) -> None:
        self._archive, self._label = archive, label
        try:
            self._zip = zipfile.ZipFile(archive)
        except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as problem:
            raise FramesError(f"The ZIP archive cannot be read ({problem}).", file=label) from None
        if len(self._zip.filelist) > _MAX_MEMBERS:
            raise FramesError(f"The ZIP archive holds more than {_MAX_MEMBERS} files.", file=label)

    def close(self) -> None:
        self._zip.close()
        self._archive.close()

    def names(self) -> Sequence[str]:
        return [info.filename for info in self._zip.infolist() if not info.is_dir()]

    def open(self, name: str) -> BinaryIO:
        info = self._zip.getinfo(name)
        if info.file_size > _MAX_MEMBER_BYTES:
            raise FramesError(f"The file would unpack to {info.file_size} bytes.", code="frames.too_large", file=name)
        try:
            with self._zip.open(info) as member:
                return io.BytesIO(member.read(_MAX_MEMBER_BYTES))
        except (zipfile.BadZipFile, OSError, EOFError, RuntimeError, NotImplementedError, ValueError) as problem:
            raise FramesError(
                f"The file inside {self._label} cannot be unpacked ({problem}).", code="frames.truncated", file=name
            ) from None
        except Exception as problem:  # zlib.error and lzma.LZMAError share no base of their own
            raise FramesError(f"The file inside {self._label} is damaged ({problem}).", file=name) from None


def one_folder(names: Sequence[str], *, label: str) -> Sequence[str]:
    """Refuse frames that lie in several folders: their order would be a guess."""
    folders = natural_order({str(PurePosixPath(name).parent) for name in names})
    if len(folders) > 1:
        raise FramesError(
            f"Images lie in several folders ({', '.join(folders[:3])}{', ...' if len(folders) > 3 else ''}).",
            code="frames.several_folders",
            file=label,
            hint="Give the frames of one film only, all in one folder.",
        )
    return names
