"""Folders as named files, the names that are looked at, and the order in which people number them."""

import posixpath
import re
from collections.abc import Iterable, Sequence
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from dropflow.errors import FramesError

IMAGE_SUFFIXES = frozenset({".tif", ".tiff", ".png", ".jpg", ".jpeg", ".bmp"})
FILM_SUFFIXES = frozenset({".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".h5", ".hdf5", ".mat", ".nd2"})
"""Which names are looked at as frames; the content then decides what they are."""


def natural_order(names: Iterable[str]) -> list[str]:
    """Sort names as people number them: ``frame2`` before ``frame10``."""
    return sorted(names, key=_natural_key)


def _natural_key(name: str) -> tuple[list[tuple[int, int | str]], str]:
    parts = re.split(r"(\d+)", name.casefold())
    return [(0, int(part)) if part.isdecimal() else (1, part) for part in parts], name


def image_names(names: Iterable[str]) -> list[str]:
    """Of `names`, those that are called like images, in natural order; what operating systems hide is left out."""
    return _called(names, IMAGE_SUFFIXES)


def film_names(names: Iterable[str]) -> list[str]:
    """Of `names`, those that are called like files of many frames each, in natural order."""
    return _called(names, FILM_SUFFIXES)


def _called(names: Iterable[str], suffixes: frozenset[str]) -> list[str]:
    # A path costs ten times what its ending does, and folders hold 20,000 names of the other kind.
    called = (PurePosixPath(name) for name in names if name[name.rfind(".") :].lower() in suffixes)
    return natural_order(str(path) for path in called if path.suffix and not _is_hidden(path))


def _is_hidden(path: PurePosixPath) -> bool:
    return any(part.startswith(".") or part == "__MACOSX" for part in path.parts)


class FolderFiles:
    """The files directly inside a folder, or with `is_deep` all below it."""

    def __init__(self, folder: Path, *, is_deep: bool = False) -> None:
        self._folder, self._is_deep = folder, is_deep

    def names(self) -> Sequence[str]:
        found = self._folder.rglob("*") if self._is_deep else self._folder.iterdir()
        return [entry.relative_to(self._folder).as_posix() for entry in found if entry.is_file()]

    def open(self, name: str) -> BinaryIO:
        try:
            return (self._folder / name).open("rb")
        except OSError as problem:
            raise FramesError(
                f"The file cannot be opened ({problem.strerror}).", code="frames.not_found", file=name
            ) from None


def one_folder(names: Sequence[str], *, label: str) -> Sequence[str]:
    """Refuse frames that lie in several folders: their order would be a guess."""
    folders = natural_order({posixpath.dirname(name) or "." for name in names})
    if len(folders) > 1:
        raise FramesError(
            f"Images lie in several folders ({', '.join(folders[:3])}{', ...' if len(folders) > 3 else ''}).",
            code="frames.several_folders",
            file=label,
            hint="Give the frames of one film only, all in one folder.",
        )
    return names
