import numpy as np
import pytest

from dropflow.simulation.cloud import Cloud, no_droplets
from dropflow.simulation.film import Film
from dropflow.simulation.render import Renderer, liquid
from dropflow.simulation.scenario import DARK, DENSE, DIRTY, SCENARIOS
from tests.dropflow.simulation.scenes import clean, cloud, small

ONE = cloud((75.0, 60.0, 0.0, 15.0))


def _droplets(seed: int = 0) -> Cloud:
    return next(Film(small(DENSE), seed).moments(1)).cloud


def test_the_same_seed_gives_the_same_frame_in_any_order() -> None:
    scenario, droplets = small(DIRTY), _droplets()
    first = Renderer(scenario, 5)
    frames = [first.frame(droplets, i) for i in (0, 1)]
    again = Renderer(scenario, 5)
    assert np.array_equal(again.frame(droplets, 1), frames[1])
    assert np.array_equal(again.frame(droplets, 0), frames[0])
    assert not np.array_equal(frames[0], frames[1])
    assert not np.array_equal(Renderer(scenario, 6).frame(droplets, 0), frames[0])


@pytest.mark.parametrize(("bits", "dtype"), [(8, np.uint8), (12, np.uint16), (16, np.uint16)])
def test_frames_use_the_range_of_their_bit_depth(bits: int, dtype: type) -> None:
    frame = Renderer(clean(bit_depth=bits), 0).frame(ONE, 0)
    brightest = 30 + 170 * 0.4515  # the sheet's share in a chord of 30 um: erf(15 / (25 sqrt 2))
    assert frame.dtype == dtype
    assert frame.shape == (192, 240)
    assert frame.max() / (2**bits - 1) * 255 == pytest.approx(brightest, abs=0.6)
    assert np.median(frame) / (2**bits - 1) * 255 == pytest.approx(30.0, abs=0.6)


def test_dark_droplets_take_light_away() -> None:
    frame = Renderer(clean(droplets="dark", background_levels=165, contrast_levels=140), 0).frame(ONE, 0) / 65535 * 255
    assert np.median(frame) == pytest.approx(165, abs=0.1)
    assert frame.min() == pytest.approx(165 - 140 * 0.4515, abs=0.6)
    assert np.unravel_index(frame.argmin(), frame.shape) == pytest.approx((96, 120), abs=1)


def test_noise_has_the_variance_of_electrons_and_readout() -> None:
    scenario = clean(electrons_per_level=5, read_noise_levels=2.0)
    frame = Renderer(scenario, 0).frame(no_droplets(), 0) / 65535 * 255
    assert frame.mean() == pytest.approx(30, abs=0.1)
    assert frame.var() == pytest.approx(30 / 5 + 4, rel=0.05)


def test_dividing_by_the_flat_field_removes_the_dirt() -> None:
    scenario = clean(n_dirt=4000, dirt_depth=0.8, vignette=0.2)
    renderer = Renderer(scenario, 3)
    frame, flat = renderer.frame(no_droplets(), 0) / 65535 * 255, renderer.flat_field() / 65535 * 255
    assert np.std(frame) > 1.0
    assert np.std(frame / (flat / flat.mean())) < 0.02


def test_the_light_changes_from_top_to_bottom_by_the_gradient() -> None:
    frame = Renderer(clean(gradient=0.5), 0).frame(no_droplets(), 0).astype(float)
    rows = frame.mean(axis=1) / frame.mean()
    assert rows[-1] - rows[0] == pytest.approx(0.5, abs=0.01)
    assert np.ptp(frame.mean(axis=0)) < 1


def test_streaks_start_at_droplets_run_away_from_the_lamp_and_fade() -> None:
    scenario = clean(streak_amplitude=0.3, streak_length_um=60.0, streak_upstream=0.0, streak_spread_px2=0.0)
    frame = Renderer(scenario, 0).frame(cloud((110.0, 60.0, 0.0, 8.0)), 0) / 65535 * 255
    stripe = np.abs(frame[80:113] - 30.0).max(axis=0)
    droplet_px = 110 / 0.625
    assert np.all(stripe[int(droplet_px + 30) :] < 0.05)
    near, far = stripe[int(droplet_px - 30)], stripe[int(droplet_px - 126)]
    assert near > 0.5
    # 96 px are one fading length of 60 um.
    assert far / near == pytest.approx(np.exp(-1), rel=0.02)


def test_a_nearer_droplet_hides_as_much_of_a_farther_one_as_it_is_opaque() -> None:
    far, near = (75.0, 60.0, -30.0, 20.0), (75.0, 60.0, 100.0, 12.0)  # the near one is out of the light
    for opacity in (0.0, 0.4, 1.0):
        scenario = clean(opacity=opacity, opacity_depth_um=0.01, defocus_px_per_um=0.0)
        seen, alone = liquid(cloud(far, near), scenario), liquid(cloud(far), scenario)
        assert seen[96, 120] == pytest.approx((1 - opacity) * alone[96, 120], abs=0.002)
        assert seen[96, 120 + 26] == pytest.approx(alone[96, 120 + 26], abs=0.001)
        assert np.array_equal(liquid(cloud(near, far), scenario), seen)


def test_a_droplet_is_moved_by_fractions_of_a_pixel() -> None:
    y, x = np.mgrid[:192, :240]
    for shift_px in (0.0, 0.25, 0.5, 0.9):
        seen = liquid(cloud(((100 + shift_px) * 0.625, 60.0, 0.0, 10.0)), clean())
        assert np.sum(seen * x) / np.sum(seen) == pytest.approx(100 + shift_px, abs=2e-3)
        assert np.sum(seen * y) / np.sum(seen) == pytest.approx(96.0, abs=2e-3)


@pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=lambda s: s.name)
def test_frames_of_every_scenario_use_the_camera_without_saturating(scenario: object) -> None:
    film = Film(small(scenario, height_px=512, width_px=612), 2)
    frame = Renderer(film.scenario, 2).frame(next(film.moments(1)).cloud, 0)
    assert np.mean(frame == 255) < 1e-4
    assert np.mean(frame == 0) < 1e-4
    assert np.percentile(frame, 99.5) - np.percentile(frame, 0.5) > 50


def test_dark_scenario_is_bright_with_dark_droplets() -> None:
    frame = Renderer(small(DARK), 0).frame(_droplets(), 0)
    assert np.median(frame) > 100
