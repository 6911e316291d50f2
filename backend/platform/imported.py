"""Files that stay where they were imported from: opened there, and only if they are what they were."""

import hashlib
from collections.abc import Mapping
from typing import BinaryIO

from backend.models.lifecycle import OUTSIDE
from backend.platform.outside import OutsideFile, Root, make_root
from backend.platform.places import READ_BYTES, Place
from dropflow.errors import FramesError


def outside_key(root: str, path: str) -> str:
    """The key of a file below a root."""
    return f"{OUTSIDE}{root}/{path}"


class Imported:
    """The roots of the settings, and the files in them that rows speak of."""

    def __init__(self, urls: Mapping[str, str]) -> None:
        self._urls = dict(urls)
        self._roots: dict[str, Root] = {}
        self._same: set[tuple[str, str, str]] = set()
        """Files whose version changed, but not their content: (key, version, checksum)."""

    def root(self, name: str) -> Root:
        """A root by its name. Raises `KeyError` if it is not on the list."""
        if name not in self._roots:
            self._roots[name] = make_root(self._urls[name])
        return self._roots[name]

    def open(self, place: Place) -> BinaryIO:
        """Open a file, or say that it is not what it was."""
        name, _, path = place.key.removeprefix(OUTSIDE).partition("/")
        if name not in self._urls:
            raise _lost(path, f"The root {name} that it was imported from is no longer on this service's list.")
        try:
            file, now = self.root(name).open(path)
        except FramesError:
            raise _lost(path, f"The file is gone from {name}, where it was imported from by reference.") from None
        if now.version != place.version and not self._has_same_content(place, file, now):
            file.close()
            raise FramesError(
                f"The file was changed in {name} since it was imported from there by reference.",
                code="frames.changed",
                file=path,
                hint="Bring back what it was, or import the frames anew.",
            )
        return file

    def _has_same_content(self, place: Place, file: BinaryIO, now: OutsideFile) -> bool:
        """Whether it was only touched, or written again as it was: its checksum decides, read once a process."""
        if now.size_bytes != place.size_bytes or place.sha256 is None:
            return False
        seen = (place.key, now.version, place.sha256)
        if seen not in self._same:
            digest = hashlib.sha256()
            while piece := file.read(READ_BYTES):
                digest.update(piece)
            file.seek(0)
            if digest.hexdigest() != place.sha256:
                return False
            self._same.add(seen)
        return True


def _lost(path: str, message: str) -> FramesError:
    return FramesError(
        message, code="frames.vanished", file=path, hint="Bring it back to where it was; then it can be used again."
    )
