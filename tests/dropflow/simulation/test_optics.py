import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.special import erf, i0e

from dropflow.errors import ParametersError
from dropflow.simulation.optics import (
    SAMPLES_PER_PX,
    bessel_i0e,
    blur_px,
    blurred_profile,
    check_is_visible,
    own_contrast,
    seen_depth_um,
)
from dropflow.simulation.render import liquid
from tests.dropflow.simulation.scenes import clean, cloud

PIXEL_UM = 0.625


def test_the_bessel_function_is_that_of_scipy() -> None:
    x = np.concatenate([[0.0], np.geomspace(1e-3, 1e4, 300)])
    assert [bessel_i0e(value) for value in x] == pytest.approx(i0e(x), rel=1e-6)


def test_in_a_thick_sheet_a_sharp_droplet_shows_its_chord() -> None:
    light, _ = blurred_profile(20.0, 0.0, 0.5, 1e4, PIXEL_UM, 0.5, 30.0)
    distance_um = np.arange(10, 120) / SAMPLES_PER_PX * PIXEL_UM
    chord_um = 2 * np.sqrt(20.0**2 - distance_um**2)
    assert light[10:120] == pytest.approx(chord_um / (np.sqrt(2 * np.pi) * 1e4), rel=0.01)


@pytest.mark.parametrize("blur", [0.7, 2.0, 8.0])
def test_blur_keeps_all_the_light(blur: float) -> None:
    profiles = blurred_profile(12.0, 5.0, blur, 25.0, PIXEL_UM, 0.5, 30.0)
    d = np.arange(len(profiles[0])) / SAMPLES_PER_PX
    chord = np.sqrt(np.maximum(12.0**2 - (d * PIXEL_UM) ** 2, 0.0))
    lit = 0.5 * (erf((5.0 + chord) / np.sqrt(2) / 25.0) - erf((5.0 - chord) / np.sqrt(2) / 25.0))
    assert np.sum(profiles[0] * d) == pytest.approx(np.sum(lit * d), rel=0.005)


def test_a_rendered_droplet_is_the_blurred_picture_of_a_finely_sampled_one() -> None:
    scenario = clean(point_spread_px=1.2, defocus_px_per_um=0.2)
    fine = 9
    centre_px, r_um, z_um = (100.3, 80.8), 9.0, 6.0
    place = (np.arange(192 * fine) + 0.5) / fine - 0.5, (np.arange(240 * fine) + 0.5) / fine - 0.5
    d2 = (place[1][None, :] - centre_px[0]) ** 2 + (place[0][:, None] - centre_px[1]) ** 2
    chord = np.sqrt(np.maximum(r_um**2 - d2 * PIXEL_UM**2, 0.0))
    scale = 1 / (np.sqrt(2) * scenario.sheet_sigma_um)
    sharp = 0.5 * (erf((z_um + chord) * scale) - erf((z_um - chord) * scale))
    sigma = float(blur_px(np.array(z_um), scenario))
    expected = gaussian_filter(sharp, sigma * fine, truncate=5)[fine // 2 :: fine, fine // 2 :: fine]
    drawn = liquid(cloud((centre_px[0] * PIXEL_UM, centre_px[1] * PIXEL_UM, z_um, r_um)), scenario)
    assert np.max(np.abs(drawn - expected)) < 0.005 * expected.max()


def test_own_contrast_is_that_of_the_rendered_droplet() -> None:
    scenario = clean()
    for r_um, z_um in ((5.0, 0.0), (12.0, 10.0), (25.0, -30.0)):
        picture = liquid(cloud((75.0, 60.0, z_um, r_um)), scenario) * scenario.contrast_levels
        y, x = np.mgrid[:192, :240]
        d, r_px = np.hypot(x - 75 / PIXEL_UM, y - 60 / PIXEL_UM), r_um / PIXEL_UM
        measured = picture[d <= r_px].mean() - picture[(d > r_px + 1) & (d <= r_px + 4)].mean()
        table = own_contrast(np.array([r_um]), np.array([z_um]), scenario)[0]
        assert table == pytest.approx(measured, rel=0.05)


def test_large_droplets_are_seen_over_a_greater_depth() -> None:
    depth = seen_depth_um(np.array([5.0, 10.0, 20.0, 40.0]), clean())
    assert np.all(np.diff(depth) > 0)
    # Where blur alone decides: 0.22 r = hypot(point spread, defocus z).
    z_um = np.sqrt((0.22 * 10.0 / PIXEL_UM) ** 2 - 1.0) / 0.2
    assert depth[1] == pytest.approx(2 * z_um, rel=0.05)


def test_light_in_which_nothing_is_visible_is_an_error() -> None:
    with pytest.raises(ParametersError, match="contrast_levels: no droplet of any radius"):
        check_is_visible(seen_depth_um(np.array([4.0, 40.0]), clean(contrast_levels=2.0)))
