import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dropflow.physics.stokes import sedimentation_um_s

radii = st.floats(0.1, 500)
densities = st.floats(-500, 500)
viscosities = st.floats(1e-4, 1.0)


def test_the_papers_own_response_time_gives_its_speed_of_big_droplets() -> None:
    """The response time tau = 2 drho r^2 / (9 eta) = 36 us at r = 40 um (section 4.2) times g is 353 um/s."""
    density_over_viscosity = 36e-6 * 9 / (2 * 40e-6**2)
    speed = sedimentation_um_s(40.0, delta_density_kg_m3=-density_over_viscosity * 1e-3, viscosity_pa_s=1e-3)
    assert speed == pytest.approx(353, abs=0.5)


@given(radii, densities, viscosities)
def test_a_lighter_droplet_rises_and_a_heavier_one_sinks(r_um: float, density: float, viscosity: float) -> None:
    """The sign along `up` is the opposite of that of the density difference."""
    speed = sedimentation_um_s(r_um, delta_density_kg_m3=density, viscosity_pa_s=viscosity)
    assert np.sign(speed) == -np.sign(density) or abs(density) < 1e-300


@given(radii, densities, viscosities, st.floats(0.5, 10))
def test_the_speed_grows_with_the_square_of_the_radius(
    r_um: float, density: float, viscosity: float, factor: float
) -> None:
    """A droplet `factor` times as large is factor^2 times as fast."""
    speeds = sedimentation_um_s([r_um, factor * r_um], delta_density_kg_m3=density, viscosity_pa_s=viscosity)
    np.testing.assert_allclose(speeds[1], factor**2 * speeds[0], rtol=1e-12, atol=1e-300)
