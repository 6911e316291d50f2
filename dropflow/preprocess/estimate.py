"""What is measured once per stack, stored, and handed to every shard, so that all frames are treated alike."""

from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Protocol
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from dropflow.errors import ExperimentError, FieldProblem, FramesError, ResultsError
from dropflow.experiment import Experiment
from dropflow.parameters import Parameters
from dropflow.preprocess.radius_range import radius_range_px


class Stack(Protocol):
    """Anything with a length whose items are grey frames of shape (rows, columns)."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> npt.NDArray[Any]: ...


@dataclass(frozen=True, eq=False)
class StackEstimate:
    """What holds for all frames of one stack."""

    shape: tuple[int, int]
    """Rows and columns of every frame."""
    flat_field: npt.NDArray[np.float32] | None
    """Shape (rows, columns), mean 1: frames are divided by it. None where the experiment gives no flat field."""

    def save(self, file: Path | IO[bytes]) -> None:
        """Write this as an .npz archive (no pickle in it)."""
        flat = np.empty((0, 0), np.float32) if self.flat_field is None else self.flat_field
        np.savez_compressed(file, shape=np.array(self.shape, np.int64), flat_field=flat)

    @staticmethod
    def load(file: Path | IO[bytes]) -> "StackEstimate":
        """Read what `save` wrote. Raises `ResultsError` for any other file."""
        try:
            # numpy leaves a file that it opened by itself open when it is no archive.
            with nullcontext(file) if not isinstance(file, Path) else file.open("rb") as opened:
                archive = np.load(opened, allow_pickle=False)
                rows, columns = (int(side) for side in archive["shape"])
                flat = archive["flat_field"]
        except (OSError, EOFError, KeyError, ValueError, IndexError, BadZipFile) as problem:
            name = str(file) if isinstance(file, Path) else None
            message = "This is no stack estimate."
            raise ResultsError(message, file=name, hint="Run the analysis again from the start.") from problem
        return StackEstimate((rows, columns), flat if flat.size else None)


def estimate_stack(
    frames: Stack, experiment: Experiment, parameters: Parameters, flat_field: npt.NDArray[Any] | None = None
) -> StackEstimate:
    """Measure what the detection of every frame of a stack shares.

    Parameters
    ----------
    frames
        The whole stack; few of its frames are read.
    experiment, parameters
        What was filmed and how it is to be analysed. (The `paper` method measures everything frame by frame.)
    flat_field
        Image of the empty field of view, shape (rows, columns), all pixels positive; None if there is none.

    Raises
    ------
    FramesError
        The stack is empty.
    ExperimentError
        The flat field does not fit the frames.
    """
    if len(frames) == 0:
        raise FramesError("There are no frames in this stack.", code="frames.empty")
    rows, columns = frames[0].shape
    radius_range_px(experiment, parameters, (rows, columns))
    flat = None if flat_field is None else normalised_flat_field(flat_field, (rows, columns))
    return StackEstimate((rows, columns), flat)


def normalised_flat_field(flat_field: npt.NDArray[Any], shape: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Return `flat_field` with mean 1; raise `ExperimentError` if it is not a positive image of `shape`."""
    if flat_field.shape != shape:
        raise _flat_field_error(f"has shape {flat_field.shape} but the frames have {shape}: give one of the same size")
    if not np.isfinite(flat_field).all():
        raise _flat_field_error("has pixels that are not finite: fill them in")
    if flat_field.min() <= 0:
        n_dark = int(np.count_nonzero(flat_field <= 0))
        raise _flat_field_error(f"has {n_dark} pixels that are not positive: frames are divided by it, so give none")
    normalised: npt.NDArray[np.float32] = (flat_field / flat_field.mean(dtype=np.float64)).astype(np.float32)
    return normalised


def _flat_field_error(problem: str) -> ExperimentError:
    fields = [FieldProblem("flat_field", problem)]
    return ExperimentError("The flat field cannot be used.", code="experiment.flat_field", fields=fields)
