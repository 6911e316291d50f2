"""Which files of a place outside are those of an experiment: its frames, and what its description names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, BinaryIO

from backend.platform.outside import OutsideFile, Root, checked_path, deep_listing
from dropflow.errors import FramesError
from dropflow.frames.opening import stack_files

FRAMES = "frames"
NAMED_ROLES = ("flat_field", "timestamps", "temperature_log")
_MARKS_OF_ZARR = {"zarr.json", ".zarray", ".zgroup"}


@dataclass(frozen=True)
class Wanted:
    """A file that is to be imported."""

    role: str
    name: str
    """What it is called in the experiment."""
    path: str
    """Where it is below the root."""
    found: OutsideFile

    @property
    def key(self) -> tuple[str, str]:
        """What tells the files of an experiment apart."""
        return (self.role, self.name)


def wanted_files(root: Root, path: str, document: Mapping[str, Any]) -> list[Wanted]:
    """The files of an experiment in a folder, or one file of frames and what lies beside it, in natural order.

    Raises
    ------
    FramesError
        There is no such path, no frames, or more than one film.
    """
    path = checked_path(path)
    single = root.look(path) if path else None
    folder = PurePosixPath(path).parent.as_posix().removeprefix(".") if single is not None else path
    found = [single] if single is not None else _files_of(root, path)
    _, names = stack_files(_Named([file.name for file in found if file.name not in _named(document).values()]))
    by_name = {file.name: file for file in found}
    beside = [
        Wanted(role, name, _joined(folder, name), file)
        for role, name in _named(document).items()
        if (file := root.look(_joined(folder, name))) is not None
    ]
    frames = [Wanted(FRAMES, name, _joined(folder, name), by_name[name]) for name in names]
    if empty := next((file for file in [*beside, *frames] if not file.found.size_bytes and not _is_zarr(names)), None):
        raise FramesError("The file is empty.", code="upload.empty", file=empty.path)
    return [*beside, *frames]


def _files_of(root: Root, path: str) -> list[OutsideFile]:
    direct = root.listing(path).files
    if not _is_zarr([file.name for file in direct]):
        return list(direct)
    return sorted(deep_listing(root, path), key=lambda file: file.name)


def _is_zarr(names: Sequence[str]) -> bool:
    return bool(_MARKS_OF_ZARR & {PurePosixPath(name).name for name in names})


def _named(document: Mapping[str, Any]) -> dict[str, str]:
    return {role: str(document[role]) for role in NAMED_ROLES if document.get(role)}


def _joined(folder: str, name: str) -> str:
    return f"{folder}/{name}" if folder else name


class _Named:
    """Names alone, of which those of frames are asked for."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names

    def names(self) -> Sequence[str]:
        return self._names

    def open(self, name: str) -> BinaryIO:
        raise NotImplementedError
