"""Which of the droplets found is the one that was predicted."""

from dataclasses import fields

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets

_WALK, _RATIO = 1.0, 1.35
"""A droplet is the predicted one within this many predicted radii, with a radius within this factor."""


def best_near(found: Droplets, predicted: Droplets) -> tuple[Droplets, npt.NDArray[np.bool_]]:
    """For each of n predictions the likeliest of the droplets near to it and like it, and whether there is any.

    Where there is none the prediction itself is returned, as improbable.
    """
    distance = np.hypot(predicted.x_px[:, None] - found.x_px[None, :], predicted.y_px[:, None] - found.y_px[None, :])
    ratio = found.r_px[None, :] / predicted.r_px[:, None]
    is_near = (distance <= _WALK * predicted.r_px[:, None]) & (ratio < _RATIO) & (ratio > 1 / _RATIO)
    # A last column stands for none.
    likelihood = np.column_stack([np.where(is_near, found.probability[None, :], -1.0), np.zeros(len(predicted))])
    best = np.argmax(likelihood, axis=1)
    is_any = best < len(found)
    result = Droplets(*(np.array(getattr(predicted, column.name), np.float64) for column in fields(Droplets)))
    result.probability[:], result.match[:] = 0.0, 0.0
    for column in fields(Droplets):
        getattr(result, column.name)[is_any] = getattr(found, column.name)[best[is_any]]
    return result, is_any
