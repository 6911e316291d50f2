"""The flat field: how bright each pixel of an empty frame is. Frames are divided by it."""

from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.errors import ExperimentError, FieldProblem


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
