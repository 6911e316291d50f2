"""Where tracking stands, on disk: rows in parts, and one state that is replaced as a whole."""

import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

Arrays = dict[str, npt.NDArray[Any]]


@dataclass(frozen=True)
class Position:
    """The next part to do, and all that must be known to do it."""

    stage: str
    n_parts_done: int
    arrays: Arrays


class Checkpoint:
    """The state after the last finished part. It is there whole or not at all, wherever the process dies.

    A state of other inputs (another `fingerprint`) counts as none.
    """

    def __init__(self, path: Path, fingerprint: str) -> None:
        self._path = path
        self._fingerprint = fingerprint

    def load(self) -> Position | None:
        """The last state saved, if there is one."""
        if not self._path.exists():
            return None
        with np.load(self._path, allow_pickle=False) as stored:
            arrays = dict(stored)
        about = json.loads(str(arrays.pop("about")))
        if about["fingerprint"] != self._fingerprint:
            return None
        return Position(about["stage"], about["n_parts_done"], arrays)

    def save(self, position: Position) -> None:
        """Replace the state."""
        about = {
            "fingerprint": self._fingerprint,
            "stage": position.stage,
            "n_parts_done": position.n_parts_done,
        }
        unfinished = self._path.with_suffix(".unfinished")
        with unfinished.open("wb") as file:
            np.savez(file, allow_pickle=False, about=np.array(json.dumps(about)), **position.arrays)
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(self._path)


class Spool:
    """Tables in numbered parts, one file each. A part written twice is the same part."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder / name
        self._folder.mkdir(parents=True, exist_ok=True)

    def write(self, part: int, table: pa.Table) -> None:
        """Write one part."""
        path = self._path(part)
        unfinished = path.with_suffix(".unfinished")
        with pa.ipc.new_file(unfinished, table.schema) as file:
            file.write_table(table)
        unfinished.replace(path)

    def read(self, part: int) -> pa.Table:
        """Read one part."""
        with pa.memory_map(str(self._path(part))) as file:
            return pa.ipc.open_file(file).read_all()

    def remove(self) -> None:
        """Delete all parts."""
        shutil.rmtree(self._folder)

    def _path(self, part: int) -> Path:
        return self._folder / f"{part:08d}.arrow"
