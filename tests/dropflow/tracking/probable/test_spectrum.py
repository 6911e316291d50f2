from dataclasses import replace

import numpy as np
import pytest

from dropflow.tracking.probable.evidence import evidence, parameters_of
from dropflow.tracking.probable.least_squares import Model, Observations
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.spectrum_estimate import estimate_spectrum
from dropflow.tracking.probable.waves import Waves
from tests.dropflow.tracking.probable.test_regression import GRID, UP, observations, random_flow, seen_in


def some_model(length_px: float = 100.0, *, share: float = 0.1) -> Model:
    spectrum = Spectrum(8.0, length_px, share, 0.05, 0.3)
    return Model(Waves.over(GRID, length_px, 4.5 / length_px), spectrum, UP, True, 0.0, 0.09)


def test_the_slope_of_the_evidence_is_that_of_its_differences() -> None:
    """With each of the five parameters."""
    model, steps = some_model(), [observations(40, seed) for seed in (1, 2)]
    parameters = parameters_of(model.spectrum) + 0.1
    slope = evidence(steps, model, parameters).slope
    step = 1e-4
    for index in range(5):
        shift = step * np.eye(5)[index]
        above, below = (evidence(steps, model, parameters + sign * shift).value for sign in (1, -1))
        assert slope[index] == pytest.approx((above - below) / (2 * step), rel=1e-2, abs=1e-2)


@pytest.mark.parametrize("length_px", [70.0, 140.0])
def test_length_and_strength_are_found_from_the_droplets(length_px: float) -> None:
    """Whatever the frame's size suggests: within a third, from three steps of 150 droplets."""
    true = some_model(length_px, share=1e-6)
    steps = [seen_in(random_flow(true, seed), 150, seed, noise_um_s=0.3) for seed in range(3)]
    found = estimate_spectrum(steps, GRID, None, UP, with_potential=True, most_iterations=25)
    assert found.spectrum.length_px == pytest.approx(length_px, rel=0.33)
    assert found.spectrum.rms_um_s == pytest.approx(8.0, rel=0.4)
    assert found.spectrum.noise_um_s == pytest.approx(0.3, rel=0.4)
    assert not found.with_potential


def test_a_flow_with_divergence_is_recognised() -> None:
    """The share of the potential is found to be large."""
    true = some_model(share=0.6)
    steps = [seen_in(random_flow(true, seed), 150, seed, noise_um_s=0.3) for seed in range(3)]
    found = estimate_spectrum(steps, GRID, None, UP, with_potential=True, most_iterations=25)
    assert found.with_potential
    assert 0.3 < found.spectrum.potential_share < 0.85


def test_energies_sum_to_the_variance_of_the_velocity() -> None:
    """Both components together, however the spectrum is shaped."""
    waves = Waves.over(GRID, 100.0, 0.045)
    for broadness in (1e-4, 0.1, 1.0):
        spectrum = Spectrum(8.0, 100.0, 0.1, broadness, 0.3)
        assert spectrum.energies(waves).sum() == pytest.approx(2 * 8.0**2)


def test_a_single_droplet_gives_some_model() -> None:
    """The priors hold where there is nothing to learn from."""
    one = observations(1)
    found = estimate_spectrum([one], GRID, None, UP, with_potential=True, most_iterations=25)
    assert np.isfinite([getattr(found.spectrum, name) for name in Spectrum.__dataclass_fields__]).all()


def test_droplets_at_rest_give_some_model() -> None:
    """A fluid without motion has no scale of its own."""
    seen = observations(20)
    at_rest = replace(seen, across_um_s=np.zeros(20), along_um_s=np.zeros(20), sedimentation_um_s=np.zeros(20))
    found = estimate_spectrum([at_rest], GRID, None, UP, with_potential=True, most_iterations=25)
    assert np.isfinite(found.prior).all()
    assert isinstance(at_rest, Observations)


@pytest.mark.parametrize("broadness", [1e-4, 0.1, 0.3])
def test_the_finest_wave_leaves_next_to_nothing_unresolved(broadness: float) -> None:
    """Of the energy of a wide lattice less than a thousandth is finer, and a tenth of the way back there is more."""
    spectrum = Spectrum(8.0, 100.0, 0.1, broadness, 0.3)
    waves = Waves(4000.0, 4000.0, 150, 150)
    energies = spectrum.energies(waves) / spectrum.energies(waves).sum()
    finest = spectrum.finest_per_px
    assert energies[waves.modulus_per_px > finest].sum() < 1e-3
    assert energies[waves.modulus_per_px > 0.9 * finest].sum() > 5e-4
