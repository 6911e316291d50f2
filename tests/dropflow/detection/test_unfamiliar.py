"""Frames that the trained model does not know are said to be so."""

import numpy as np
import pytest

from dropflow.detection.unfamiliar import TOLERATED_SHARE, unfamiliar_share, warnings_of
from dropflow.preprocess import StackEstimate
from tests.dropflow.detection.discs import ISOLATED, OVERLAPPING, SHAPE, detector_for, draw


def half_empty_rings(discs):
    """Rings with a dark middle: nothing that fills a circle."""
    rows, columns = np.indices(SHAPE)
    image = np.full(SHAPE, 30.0)
    for x, y, r in discs:
        distance = np.hypot(columns - x, rows - y)
        image[np.abs(distance - r) < 2] = 200
        image[distance < r - 2] = 0
    return image.astype(np.uint8)


def test_drawn_droplets_are_familiar_and_rings_are_not():
    known, unknown = draw(ISOLATED + OVERLAPPING), half_empty_rings(ISOLATED)
    shares = [unfamiliar_share([frame] * 3, detector_for(frame)) for frame in (known, unknown)]
    assert shares[0] < shares[1]
    assert shares[1] > TOLERATED_SHARE


def test_a_frame_without_droplets_is_not_unfamiliar():
    frame = np.full(SHAPE, 9, np.uint8)
    assert unfamiliar_share([frame], detector_for(frame)) == 0


def test_a_method_without_a_model_knows_no_unfamiliar_frames():
    frame = half_empty_rings(ISOLATED)
    assert unfamiliar_share([frame], detector_for(frame, method="paper")) == 0


@pytest.mark.parametrize(("share", "n_warnings"), [(0.0, 0), (0.02, 0), (0.08, 1)])
def test_people_are_told(share, n_warnings):
    warnings = warnings_of(StackEstimate((3, 4), None, unfamiliar_share=share))
    assert len(warnings) == n_warnings
    assert all(w["code"] == "detection.unfamiliar" and "8 %" in w["message"] for w in warnings)
