"""The files of a film as they are sent: the frames, and what the experiment names beside them."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dropflow.errors import ExperimentError, FieldProblem
from dropflow.experiment import Experiment

READ_BYTES = 1 << 20
NAMED = ("flat_field", "timestamps", "temperature_log")
"""Fields of an experiment that name a file; the role of such a file is the field's name."""


@dataclass(frozen=True)
class FilmFile:
    """One file, what it is called on the server, and what it is for."""

    path: Path
    name: str
    role: str
    size_bytes: int

    @property
    def key(self) -> tuple[str, str]:
        """What tells the files of an experiment apart."""
        return (self.role, self.name)

    def sha256(self) -> str:
        """The checksum of what is in the file now."""
        digest = hashlib.sha256()
        for piece in pieces_of(self.path):
            digest.update(piece)
        return digest.hexdigest()


def film_files(stack: Path, experiment: Experiment, beside: Path) -> list[FilmFile]:
    """All files of a film: those it names, looked up in `beside`, then its frames in natural order."""
    # Imported here, for it takes seconds that nobody who only looks at results need wait.
    from dropflow.frames.opening import stack_files

    _, names = stack_files(stack)
    folder = stack if stack.is_dir() else stack.parent
    named = {role: getattr(experiment, role) for role in NAMED}
    attached = [_file(beside / name, str(name), role) for role, name in named.items() if name is not None]
    return [*attached, *(_file(folder / name, name, "frames") for name in names)]


def _file(path: Path, name: str, role: str) -> FilmFile:
    try:
        return FilmFile(path, name, role, path.stat().st_size)
    except OSError as problem:
        message = f"the file {path} cannot be read ({problem.strerror})"
        raise ExperimentError("A file is missing.", fields=[FieldProblem(role, message)]) from None


def pieces_of(path: Path, start: int = 0, stop: int | None = None) -> Iterator[bytes]:
    """The bytes of a file from `start` until before `stop`, never all at once."""
    left = None if stop is None else stop - start
    with path.open("rb") as file:
        file.seek(start)
        while left is None or left > 0:
            piece = file.read(READ_BYTES if left is None else min(READ_BYTES, left))
            if not piece:
                return
            left = None if left is None else left - len(piece)
            yield piece


def submission_key(document: dict[str, Any], files: list[FilmFile], group_id: str | None) -> str:
    """A name for "this film, so described": the same command gives the same name, after a kill or on another day."""
    about = [document, group_id, [(file.role, file.name, file.size_bytes) for file in files]]
    return hashlib.sha256(json.dumps(about, sort_keys=True, default=str).encode()).hexdigest()


def import_key(document: dict[str, Any], root: str, path: str, group_id: str | None) -> str:
    """The same for a film that the server takes from one of its import roots."""
    return hashlib.sha256(
        json.dumps([document, group_id, "import", root, path], sort_keys=True, default=str).encode()
    ).hexdigest()
