"""Looking in the image at predicted places, and believing only what is where it may be."""

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dropflow.droplets import Droplets
from dropflow.tracking.follow import Look
from dropflow.tracking.probable.directions import turned
from dropflow.tracking.probable.expectation import Predicted

SIMILAR_RATIO = (0.6, 1.67)
"""Between these lies the ratio of the radii of two sightings of one droplet."""
_MOST_SQUARED_DISTANCE = 14.0
"""Of a sighting from its prediction, in units of the errors: 1 in 1000 right ones are further off."""
_MOST_RADIUS_DEVIATION = 3.5


def sure_look(look: Look, predicted: Predicted) -> Look:
    """`look`, for some of the `predicted` droplets, which takes only what agrees with the errors of the prediction."""
    places = cKDTree(np.column_stack([predicted.droplets.x_px, predicted.droplets.y_px]))

    def sure(expected: Droplets) -> tuple[Droplets, npt.NDArray[np.bool_]]:
        sighted, is_good = look(expected)
        if not len(expected):
            return sighted, is_good
        _, index = places.query(np.column_stack([expected.x_px, expected.y_px]))
        across, along = turned(sighted.x_px - expected.x_px, sighted.y_px - expected.y_px, predicted.up)
        seen = sighted.x_std_px**2
        squared = across**2 / (predicted.across_variance[index] + seen)
        squared += along**2 / (predicted.along_variance[index] + seen)
        log_ratio = np.log(sighted.r_px / expected.r_px)
        deviation = np.abs(log_ratio) / np.hypot(predicted.log_r_std[index], sighted.r_std_px / sighted.r_px)
        return sighted, is_good & (squared < _MOST_SQUARED_DISTANCE) & (deviation < _MOST_RADIUS_DEVIATION)

    return sure
