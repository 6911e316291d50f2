"""What is measured once per stack, stored, and handed to every shard, so that all frames are treated alike."""

from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import IO
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from dropflow.errors import ResultsError
from dropflow.preprocess.stripes import NO_STRIPES, Direction, Stripes

ESTIMATE_FILE = "estimate.npz"
"""What a stack estimate is kept as beside what else a run made."""


@dataclass(frozen=True, eq=False)
class StackEstimate:
    """What holds for all frames of one stack."""

    shape: tuple[int, int]
    """Rows and columns of every frame."""
    flat_field: npt.NDArray[np.float32] | None
    """Shape (rows, columns), mean 1: frames are divided by it. None where none is given, nor could be estimated."""
    stripes: Stripes = NO_STRIPES
    """Lines of light and shadow along the frames. The method `paper` filters instead, and has none measured."""
    is_flat_field_estimated: bool = False
    """From the frames themselves, see `dropflow.preprocess.background`."""
    unfamiliar_share: float = 0.0
    """Part of the features of some frames' droplets that the model of the method `default` was not trained for."""

    def save(self, file: Path | IO[bytes]) -> None:
        """Write this as an .npz archive (no pickle in it)."""
        flat = np.empty((0, 0), np.float32) if self.flat_field is None else self.flat_field
        np.savez_compressed(
            file,
            shape=np.array(self.shape, np.int64),
            flat_field=flat,
            stripes_along=np.array(self.stripes.direction.value),
            stripes_share=np.array(self.stripes.share),
            is_flat_field_estimated=np.array(self.is_flat_field_estimated),
            unfamiliar_share=np.array(self.unfamiliar_share),
        )

    @staticmethod
    def load(file: Path | IO[bytes]) -> "StackEstimate":
        """Read what `save` wrote. Raises `ResultsError` for any other file."""
        try:
            # numpy leaves a file that it opened by itself open when it is no archive.
            with nullcontext(file) if not isinstance(file, Path) else file.open("rb") as opened:
                archive = np.load(opened, allow_pickle=False)
                rows, columns = (int(side) for side in archive["shape"])
                flat = archive["flat_field"]
                stripes = Stripes(Direction(str(archive["stripes_along"])), float(archive["stripes_share"]))
                is_estimated = bool(archive["is_flat_field_estimated"])
                unfamiliar_share = float(archive["unfamiliar_share"])
        except (OSError, EOFError, KeyError, ValueError, IndexError, BadZipFile) as problem:
            name = str(file) if isinstance(file, Path) else None
            message = "This is no stack estimate."
            raise ResultsError(message, file=name, hint="Run the analysis again from the start.") from problem
        return StackEstimate((rows, columns), flat if flat.size else None, stripes, is_estimated, unfamiliar_share)
