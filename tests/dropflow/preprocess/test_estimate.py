"""What is measured once per stack, and the flat field that frames are divided by."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from dropflow.errors import ExperimentError, FramesError, ParametersError, ResultsError
from dropflow.experiment import DropletTone
from dropflow.preprocess import StackEstimate, Stripes, corrected, estimate_stack
from dropflow.preprocess.stripes import Direction
from tests.dropflow.detection.discs import experiment, parameters

FRAME = np.full((100, 120), 50, np.uint8)


def flat_field(**changes):
    flat = np.linspace(0.5, 1.5, FRAME.size).reshape(FRAME.shape) * 200
    for place, value in changes.items():
        flat.ravel()[int(place[1:])] = value
    return flat


def test_the_flat_field_is_normalised_to_mean_one():
    estimate = estimate_stack([FRAME], experiment(), parameters(), flat_field())
    assert estimate.flat_field.dtype == np.float32
    assert estimate.flat_field.mean() == pytest.approx(1, abs=1e-6)
    assert estimate.shape == (100, 120)


def test_a_frame_of_the_empty_field_becomes_even():
    flat = flat_field()
    estimate = estimate_stack([FRAME], experiment(), parameters(), flat)
    image = corrected((flat * 0.25).astype(np.float32), estimate, DropletTone.BRIGHT)
    assert image == pytest.approx(image.mean(), rel=1e-5)


def test_dark_inverts_and_nothing_else():
    estimate = StackEstimate((100, 120), None)
    frame = np.arange(12_000, dtype=np.uint16).reshape(100, 120)
    assert (corrected(frame, estimate, DropletTone.DARK) == -frame.astype(np.float32)).all()
    assert (corrected(frame, estimate, DropletTone.BRIGHT) == frame).all()


@pytest.mark.parametrize("flat", [None, flat_field()], ids=["without", "with flat field"])
def test_an_estimate_survives_being_stored(flat, tmp_path):
    estimate = replace(
        estimate_stack([FRAME], experiment(), parameters(), flat),
        stripes=Stripes(Direction.COLUMNS, 0.7),
        is_flat_field_estimated=True,
        unfamiliar_share=0.1,
    )
    buffer = BytesIO()
    estimate.save(buffer)
    buffer.seek(0)
    estimate.save(tmp_path / "estimate.npz")
    for read in StackEstimate.load(buffer), StackEstimate.load(tmp_path / "estimate.npz"):
        assert read.shape == estimate.shape
        for name in ("stripes", "is_flat_field_estimated", "unfamiliar_share"):
            assert getattr(read, name) == getattr(estimate, name)
        assert (read.flat_field is None) == (flat is None)
        assert flat is None or (read.flat_field == estimate.flat_field).all()


@pytest.mark.parametrize("content", [b"", b"not an archive", b"PK\x03\x04 but broken"])
def test_another_file_is_no_estimate(content, tmp_path):
    file = tmp_path / "estimate.npz"
    file.write_bytes(content)
    with pytest.raises(ResultsError, match=r"estimate\.npz"):
        StackEstimate.load(file)
    np.savez(file, something=np.arange(3))
    with pytest.raises(ResultsError, match="no stack estimate"):
        StackEstimate.load(file)


@pytest.mark.parametrize(
    ("flat", "told"),
    [
        (np.ones((50, 60)), r"shape \(50, 60\).*\(100, 120\)"),
        (np.ones((100, 120, 3)), "shape"),
        (flat_field(p5=0), "1 pixels that are not positive"),
        (flat_field(p5=-3, p6=0), "2 pixels that are not positive"),
        (flat_field(p5=np.nan), "not finite"),
        (flat_field(p5=np.inf), "not finite"),
    ],
)
def test_a_flat_field_that_cannot_divide_is_refused(flat, told):
    with pytest.raises(ExperimentError, match=told) as caught:
        estimate_stack([FRAME], experiment(), parameters(), flat)
    assert caught.value.code == "experiment.flat_field"
    assert [problem.field for problem in caught.value.fields] == ["flat_field"]


def test_an_empty_stack_is_refused():
    with pytest.raises(FramesError) as caught:
        estimate_stack([], experiment(), parameters())
    assert caught.value.code == "frames.empty"


@pytest.mark.parametrize(
    ("shape", "radii", "field", "told"),
    [
        ((100, 120), (1.9, 40.0), "detection.radius_min_um", "1.9 px"),
        ((100, 120), (5.0, 50.1), "detection.radius_max_um", "at most 50 um"),
        ((1, 1), (2.0, 3.0), "detection.radius_max_um", "1 x 1 px"),
    ],
)
def test_radii_that_do_not_fit_the_frames_are_refused(shape, radii, field, told):
    knobs = parameters(radius_min_um=radii[0], radius_max_um=radii[1])
    with pytest.raises(ParametersError) as caught:
        estimate_stack([np.zeros(shape, np.uint8)], experiment(), knobs)
    assert caught.value.code == "parameters.radius_range"
    assert [problem.field for problem in caught.value.fields] == [field]
    assert told in str(caught.value)


def test_radii_are_compared_in_pixels():
    """4 um at 10 um a pixel is too small, whatever the frame."""
    film = experiment(pixel_size_um=10.0)
    with pytest.raises(ParametersError, match=r"0\.4 px.*at least 20 um"):
        estimate_stack([FRAME], film, parameters(radius_min_um=4.0, radius_max_um=400.0))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300])
def test_a_frame_with_levels_that_are_no_numbers_is_refused(value):
    frame = FRAME.astype(float)
    frame[3, 4] = value
    with pytest.raises(FramesError) as caught:
        corrected(frame, StackEstimate(FRAME.shape, None), DropletTone.BRIGHT)
    assert caught.value.code == "frames.not_finite"


def test_a_frame_of_another_size_is_refused():
    with pytest.raises(FramesError, match=r"\(100, 120\).*\(90, 120\)"):
        corrected(FRAME, StackEstimate((90, 120), None), DropletTone.BRIGHT)
