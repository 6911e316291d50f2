"""Measuring once what all frames of a stack share."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.experiment import Experiment
from dropflow.parameters import Method, Parameters
from dropflow.preprocess.background import Stack, estimated_flat_field
from dropflow.preprocess.estimate import StackEstimate
from dropflow.preprocess.flat_field import normalised_flat_field
from dropflow.preprocess.frame import corrected
from dropflow.preprocess.stripes import measure_stripes
from dropflow.radius_range import radius_range_px

N_SAMPLED = 5
"""So many frames are looked at."""


def estimate_stack(
    frames: Stack, experiment: Experiment, parameters: Parameters, flat_field: npt.NDArray[Any] | None = None
) -> StackEstimate:
    """Measure what the detection of every frame of a stack shares.

    Parameters
    ----------
    frames
        The whole stack; few of its frames are read.
    experiment, parameters
        What was filmed and how it is to be analysed.
    flat_field
        Image of the empty field of view, shape (rows, columns), all pixels positive; None if there is none. The
        method `default` then estimates what a film of at least 9 frames tells (`dropflow.preprocess.background`).

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
    estimate = StackEstimate((rows, columns), flat)
    if parameters.detection.method is Method.PAPER:
        return estimate
    if flat is None:
        largest_px = parameters.detection.radius_max_um / experiment.pixel_size_um
        flat = estimated_flat_field(frames, experiment.droplets, r_max_px=largest_px)
        estimate = replace(estimate, flat_field=flat, is_flat_field_estimated=flat is not None)
    some = [corrected(frames[index], estimate, experiment.droplets) for index in sampled(len(frames))]
    return replace(estimate, stripes=measure_stripes(some))


def sampled(n_frames: int, n_most: int = N_SAMPLED) -> list[int]:
    """Frames that stand for all, spread evenly over the stack."""
    return [int(index) for index in np.unique(np.linspace(0, n_frames - 1, min(n_most, n_frames)).round())]
