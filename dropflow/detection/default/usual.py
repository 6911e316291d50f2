"""What is usual in a frame: whether an edge is strong depends on the others."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.features import (
    CONTRAST_USUAL,
    DIP,
    EDGE_SHARE,
    EDGE_USUAL,
    FRAME_DIP,
    FRAME_EDGE,
    FRAME_SHARPNESS,
    RING_LEVEL,
    SHARPNESS,
    SPREAD,
)

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

_BACKGROUND_PERCENT = 30.0
_CLEAR_SPREAD, _CLEAR_SHARE = 0.06, 0.8
_LEAST_CLEAR = 5


@dataclass(frozen=True)
class Usual:
    """What is usual in a frame; brightness in its own levels."""

    background: float
    edge: float
    contrast: float
    dip: float
    sharpness: float
    noise: float


def usual_of(features: Column, image: Image, noise: float) -> Usual:
    """Background of a frame, edge and contrast of its clear droplets, from the levels that `measure` leaves."""
    background = float(np.percentile(image[::8, ::8], _BACKGROUND_PERCENT))
    edges, contrasts = features[:, EDGE_USUAL], features[:, CONTRAST_USUAL]
    is_clear = (features[:, SPREAD] < _CLEAR_SPREAD) & (features[:, EDGE_SHARE] > _CLEAR_SHARE) & (contrasts > 0)
    if is_clear.sum() < _LEAST_CLEAR:
        is_clear = (edges > 0) & (contrasts > 0)
    if not is_clear.any():
        return Usual(background, noise, noise, 0.0, 1.0, noise)
    upper_edge, upper_contrast = (float(np.percentile(column[is_clear], 75)) for column in (edges, contrasts))
    dip, sharpness = (float(np.median(features[is_clear, which])) for which in (DIP, SHARPNESS))
    return Usual(background, upper_edge, upper_contrast, dip, sharpness, noise)


def relate_to_frame(features: Column, usual: Usual) -> None:
    """Turn the levels that `measure` leaves into features, in place: what is a strong edge depends on the frame."""
    features[:, RING_LEVEL] = (features[:, RING_LEVEL] - usual.background) / usual.edge
    features[:, EDGE_USUAL] = np.log(features[:, EDGE_USUAL] / usual.edge)
    features[:, CONTRAST_USUAL] /= usual.contrast
    features[:, FRAME_EDGE] = np.log(usual.edge / usual.noise)
    features[:, FRAME_DIP], features[:, FRAME_SHARPNESS] = usual.dip, usual.sharpness
