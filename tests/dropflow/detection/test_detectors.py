"""What every way of detecting droplets must do, whatever its method."""

import dataclasses
import pickle

import numpy as np
import pytest

from dropflow.droplets import Droplets
from dropflow.errors import FramesError
from dropflow.parameters import Method
from tests.dropflow.detection.discs import ISOLATED, OVERLAPPING, SHAPE, detector_for, draw, find, nearest

METHODS = pytest.mark.parametrize("method", list(Method))
FRAMES = {"isolated": ISOLATED, "overlapping": OVERLAPPING}


def as_rows(droplets):
    return np.column_stack([droplets.x_px, droplets.y_px, droplets.r_px])


def assert_same(droplets, other, discs):
    """Each disc is found alike; of what else is found, few stand on the edge of being found."""
    for disc in discs:
        (distance, ratio), (other_distance, other_ratio) = nearest(droplets, disc), nearest(other, disc)
        assert distance == pytest.approx(other_distance, abs=0.3)
        assert ratio == pytest.approx(other_ratio, abs=0.03)
    assert len(droplets) == pytest.approx(len(other), abs=2)


@METHODS
@pytest.mark.parametrize("discs", FRAMES.values(), ids=FRAMES)
def test_droplets_are_found_where_they_are(method, discs):
    droplets = find(draw(discs), method=method)
    for disc in discs:
        distance, ratio = nearest(droplets, disc)
        assert distance < max(0.5, 0.1 * disc[2])
        assert 0.8 < ratio < 1.15


@METHODS
def test_every_droplet_says_how_sure_it_is(method):
    detector = detector_for(draw(OVERLAPPING), method=method)
    found = detector.detect(detector.prepare(draw(OVERLAPPING)))
    for droplets in found.droplets, found.rejected.droplets:
        assert np.isfinite([droplets.match, droplets.x_std_px, droplets.r_std_px, droplets.probability]).all()
        assert (droplets.x_std_px > 0).all()
        assert (droplets.r_std_px > 0).all()
        assert ((droplets.probability >= 0) & (droplets.probability <= 1)).all()
    assert len(found.rejected.reasons) == len(found.rejected.droplets) > 0
    assert all(reason.isidentifier() for reason in found.rejected.reasons)


@METHODS
@pytest.mark.parametrize("discs", FRAMES.values(), ids=FRAMES)
def test_dark_droplets_in_the_inverted_frame_are_the_same(method, discs):
    frame = draw(discs)
    assert_same(find(frame, method=method), find(255 - frame, method=method, tone="dark"), discs)


@METHODS
@pytest.mark.parametrize(
    "regrade",
    [lambda f: f.astype(np.uint16) * 257, lambda f: f / 3e4 - 7, lambda f: (f // 2 + 100).astype(np.uint8)],
    ids=["16 bit", "float", "half the contrast"],
)
def test_the_scale_of_the_levels_does_not_matter(method, regrade):
    frame = draw(OVERLAPPING)
    assert_same(find(frame, method=method), find(regrade(frame), method=method), OVERLAPPING)


@METHODS
@pytest.mark.parametrize("discs", FRAMES.values(), ids=FRAMES)
@pytest.mark.parametrize("axis", [0, 1])
def test_a_flipped_frame_has_flipped_droplets(method, discs, axis):
    flipped = find(np.flip(draw(discs), axis), method=method)
    place = np.array(getattr(flipped, "yx"[axis] + "_px"))
    getattr(flipped, "yx"[axis] + "_px")[:] = SHAPE[axis] - 1 - place
    assert_same(find(draw(discs), method=method), flipped, discs)


@METHODS
@pytest.mark.parametrize("shift", [(8, 6), (7, 5)])
def test_a_shifted_frame_has_shifted_droplets(method, shift):
    dx, dy = shift
    moved = find(draw([(x + dx, y + dy, r) for x, y, r in ISOLATED]), method=method)
    moved.x_px[:] -= dx
    moved.y_px[:] -= dy
    for disc in ISOLATED:
        assert nearest(moved, disc) == pytest.approx(nearest(find(draw(ISOLATED), method=method), disc), abs=0.3)


@METHODS
def test_a_transposed_image_has_transposed_droplets(method):
    """Of the prepared image: preparing treats x and y differently, for stripes run along x."""
    detector = detector_for(draw(OVERLAPPING), method=method)
    image = detector.prepare(draw(OVERLAPPING))
    droplets = detector.detect(image).droplets
    transposed = detector.detect(np.ascontiguousarray(image.T)).droplets
    assert_same(droplets, dataclasses.replace(transposed, x_px=transposed.y_px, y_px=transposed.x_px), OVERLAPPING)


@METHODS
def test_preparing_leaves_the_frame_as_it_is(method):
    frame = draw(ISOLATED)
    before = frame.copy()
    image = detector_for(frame, method=method).prepare(frame)
    assert (frame == before).all()
    assert image.shape == frame.shape
    assert image.dtype == np.float32


@METHODS
def test_the_same_frame_gives_the_same_droplets_in_another_process(method):
    """A detector crosses a process border and keeps no state."""
    frame = draw(OVERLAPPING)
    detector = detector_for(frame, method=method)
    copied = pickle.loads(pickle.dumps(detector))  # noqa: S301
    detector.detect(detector.prepare(draw(ISOLATED)))
    rows = [as_rows(one.detect(one.prepare(frame)).droplets) for one in (detector, copied)]
    assert np.array_equal(*rows)


@METHODS
@pytest.mark.parametrize("level", [0, 77, 255])
def test_a_constant_or_saturated_frame_has_no_droplets(method, level):
    assert len(find(np.full(SHAPE, level, np.uint8), method=method)) == 0


@METHODS
def test_a_constant_frame_of_large_floats_has_no_droplets(method):
    assert len(find(np.full(SHAPE, 123456.789e3), method=method)) == 0


@METHODS
def test_pure_noise_has_no_droplets(method):
    noise = np.random.default_rng(0).normal(100, 12, (600, 700))
    assert len(find(np.rint(noise).astype(np.uint8), method=method)) == 0


@METHODS
@pytest.mark.parametrize("contrast", [40, 200])
def test_one_droplet_in_an_empty_frame_is_found(method, contrast):
    """Though it covers a tenth of a percent of the frame."""
    droplets = find(draw([(200, 150, 9)], shape=(500, 600), level=20, contrast=contrast, noise=2), method=method)
    assert len(droplets) == 1
    assert nearest(droplets, (200, 150, 9)) == pytest.approx((0, 0.95), abs=0.2)


@METHODS
def test_one_bright_pixel_is_no_droplet(method):
    frame = np.full(SHAPE, 60, np.uint8)
    frame[100, 100] = 255
    assert len(find(frame, method=method)) == 0


@METHODS
def test_a_droplet_larger_than_the_frame_is_not_found(method):
    """Its middle fills the frame: nothing of the radii looked for is there."""
    frame = draw([(180, 150, 500)])
    assert len(find(frame, method=method)) == 0


@METHODS
def test_a_frame_with_nan_is_refused(method):
    frame = draw(ISOLATED).astype(np.float32)
    detector = detector_for(frame, method=method)
    frame[10, 10] = np.nan
    with pytest.raises(FramesError) as caught:
        detector.prepare(frame)
    assert caught.value.code == "frames.not_finite"


@METHODS
def test_the_smallest_frame_that_holds_the_radii_works(method):
    """10 x 10 px for radii of 2 to 5 px, with and without a droplet."""
    frame = draw([(4.5, 4.5, 3)], shape=(10, 10))
    find(frame, method=method, radius_min_um=2.0, radius_max_um=5.0)
    assert len(find(np.full((10, 10), 9), method=method, radius_min_um=2.0, radius_max_um=5.0)) == 0


def predicted(x, y, r):
    columns = np.array([x]), np.array([y]), np.array([r])
    return Droplets(*(c.astype(float) for c in columns), *[np.ones(1)] * 4)


@METHODS
@pytest.mark.parametrize("disc", ISOLATED, ids=str)
def test_a_droplet_is_found_near_its_prediction(method, disc):
    frame = draw(ISOLATED)
    detector = detector_for(frame, method=method)
    x, y, r = disc
    known = detector.detect(detector.prepare(frame)).droplets
    found, is_good = detector.find_near(detector.prepare(frame), predicted(x + 0.3 * r, y - 0.2 * r, 1.1 * r), known)
    assert is_good.tolist() == [True]
    assert np.hypot(found.x_px[0] - x, found.y_px[0] - y) < 0.5
    assert 0.8 < found.r_px[0] / r < 1.15


@METHODS
@pytest.mark.parametrize(
    "prediction",
    [(150, 240, 10), (300, 90, 9), (60, 70, 30), (300, 180, 24), (-20, 70, 9), (60, 5000, 9)],
    ids=["nothing there", "much smaller", "much larger", "far away", "beside the frame", "far outside"],
)
def test_no_droplet_is_found_where_none_like_the_predicted_is(method, prediction):
    frame = draw(ISOLATED)
    detector = detector_for(frame, method=method)
    found, is_good = detector.find_near(detector.prepare(frame), predicted(*prediction), Droplets.empty())
    assert is_good.tolist() == [False]
    assert np.isfinite(as_rows(found)).all()
    assert np.isfinite(found.match).all()


@METHODS
def test_no_prediction_gives_no_droplet(method):
    detector = detector_for(draw(ISOLATED), method=method)
    found, is_good = detector.find_near(detector.prepare(draw(ISOLATED)), Droplets.empty(), Droplets.empty())
    assert len(found) == len(is_good) == 0


@METHODS
def test_droplets_beside_known_ones_are_found_as_well_as_without_knowing(method):
    """Of many droplets in pairs that overlap one is not known: it is found near its prediction all the same."""
    rng = np.random.default_rng(0)
    discs = [(60 + 90 * k, 60 + 90 * n, rng.uniform(9, 14)) for k in range(5) for n in range(5)]
    discs += [(x + 1.5 * r, y, 0.9 * r) for x, y, r in discs[1:]]
    frame = draw(discs, shape=(480, 480))
    detector = detector_for(frame, method=method)
    image = detector.prepare(frame)
    known = detector.detect(image).droplets
    is_known = np.hypot(known.x_px - discs[12][0], known.y_px - discs[12][1]) > 5
    known = known[is_known]
    assert len(known) > 20
    x, y, r = discs[12]
    for some in (known, Droplets.empty()):
        found, is_good = detector.find_near(image, predicted(x + 2, y - 2, r), some)
        assert is_good.tolist() == [True]
        assert np.hypot(found.x_px[0] - x, found.y_px[0] - y) < 0.1 * r
    nowhere = predicted(105.0, 105.0, 10.0)
    assert not detector.find_near(image, nowhere, known)[1].any()
