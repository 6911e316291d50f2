from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dropflow.tracking.grid import Grid
from dropflow.tracking.probable.directions import turned, unturned
from dropflow.tracking.probable.least_squares import Model, Observations
from dropflow.tracking.probable.regression import WaveFlow, regress
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.waves import Waves

Floats = npt.NDArray[np.float64]

GRID = Grid(height_px=400, width_px=500, n_rows=8, n_columns=10)
UP = (0.6, -0.8)


def model(*, length_px: float = 150.0, with_potential: bool = True, noise_um_s: float = 0.5) -> Model:
    spectrum = Spectrum(10.0, length_px, 0.2 if with_potential else 1e-6, 0.2, noise_um_s)
    return Model(Waves.over(GRID, length_px, 4.5 / length_px), spectrum, UP, with_potential, -0.1, 0.04)


def observations(n: int, seed: int = 0) -> Observations:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 499, n), rng.uniform(0, 399, n)
    across, along, sinking = rng.normal(0, 10, n), rng.normal(0, 10, n), rng.uniform(1, 20, n)
    return Observations(
        x, y, across, along, sinking, rng.uniform(0.1, 1, n), rng.uniform(0.1, 2, n), rng.uniform(0.2, 1, n)
    )


def design(given_model: Model, x: Floats, y: Floats, sinking: Floats) -> Floats:
    """Velocity across and along `up` for each unknown being one, written out: shape (2 n, n_unknowns)."""
    waves = given_model.waves
    k_x, k_y = waves.k_per_px
    columns = [
        np.concatenate([np.ones(len(x)), np.zeros(len(x))]),
        np.concatenate([np.zeros(len(x)), np.ones(len(x))]),
        np.concatenate([np.zeros(len(x)), sinking]),
    ]
    for direction in waves.directions(UP, with_potential=given_model.with_potential):
        for turn in (np.cos, np.sin):
            values = turn(np.outer(x, k_x) + np.outer(y, k_y))
            columns.extend(np.concatenate([values * direction[0], values * direction[1]]).T)
    return np.column_stack(columns)


@pytest.mark.parametrize("with_potential", [True, False])
def test_it_is_gaussian_process_regression(with_potential: bool) -> None:
    """Amplitudes and errors are those of the textbook's n^3 formula with the covariance that the waves make."""
    assumed, seen = model(with_potential=with_potential), observations(60)
    flow = regress(seen, assumed)
    phi = design(assumed, seen.x_px, seen.y_px, seen.sedimentation_um_s)
    noise = np.concatenate([seen.across_variance, seen.along_variance]) + assumed.spectrum.noise_um_s**2
    values = np.concatenate([seen.across_um_s, seen.along_um_s - assumed.factor_mean * seen.sedimentation_um_s])
    covariance = (phi * assumed.prior) @ phi.T + np.diag(noise / np.tile(seen.weight, 2))
    expected = assumed.prior * (phi.T @ np.linalg.solve(covariance, values))
    np.testing.assert_allclose(flow.amplitudes, expected, atol=1e-7)
    x, y = np.array([3.0, 250.0, 490.0]), np.array([390.0, 100.0, 5.0])
    there = design(assumed, x, y, np.zeros(3))
    np.testing.assert_allclose(flow.at(x, y), unturned(*(there @ expected).reshape(2, -1), UP), atol=1e-7)
    prior = (there * assumed.prior) @ there.T
    gain = np.linalg.solve(covariance, phi @ (there * assumed.prior).T)
    variance = np.diag(prior - (there * assumed.prior) @ phi.T @ gain).reshape(2, -1)
    np.testing.assert_allclose(flow.variance_at(x, y), variance, rtol=1e-5)


@settings(max_examples=20, deadline=None)
@given(st.floats(-100, 100), st.floats(-100, 100), st.integers(0, 1000))
def test_a_uniform_flow_is_found(u: float, v: float, seed: int) -> None:
    """Whatever its size: the mean is free."""
    n = 40
    rng = np.random.default_rng(seed)
    across, along = turned(np.full(n, u), np.full(n, v), UP)
    fine, nothing = np.full(n, 1e-4), np.zeros(n)
    seen = Observations(rng.uniform(0, 499, n), rng.uniform(0, 399, n), across, along, nothing, fine, fine, np.ones(n))
    found = regress(seen, model(noise_um_s=1e-2)).at(np.array([250.0]), np.array([200.0]))
    np.testing.assert_allclose(found[:, 0], [u, v], atol=0.15 + 0.02 * np.hypot(u, v))


def random_flow(assumed: Model, seed: int) -> WaveFlow:
    """A flow drawn from the prior."""
    rng = np.random.default_rng(seed)
    amplitudes = rng.normal(size=len(assumed.prior)) * np.sqrt(assumed.prior)
    amplitudes[:3] = 0
    return replace(regress(observations(5), assumed), amplitudes=amplitudes)


def seen_in(truth: WaveFlow, n: int, seed: int, *, stokes_error: float = 0.0, noise_um_s: float = 0.5) -> Observations:
    """Droplets carried by a flow, with noise and sedimentation."""
    rng = np.random.default_rng(seed)
    x, y, sinking = rng.uniform(0, 499, n), rng.uniform(0, 399, n), rng.uniform(1, 40, n)
    across, along = turned(*truth.at(x, y), UP)
    across, along = (part + rng.normal(0, noise_um_s, n) for part in (across, along))
    known = np.full(n, 1e-6)
    return Observations(x, y, across, along + stokes_error * sinking, sinking, known, known, np.ones(n))


def test_a_flow_is_found_to_within_the_error_that_is_said() -> None:
    """Over many flows from the prior, errors in units of what is said have a spread of one."""
    assumed = model()
    x, y = (places.ravel() for places in np.meshgrid(np.linspace(20, 480, 6), np.linspace(20, 380, 6)))
    off = []
    for seed in range(30):
        truth = random_flow(assumed, seed)
        flow = regress(seen_in(truth, 60, seed + 100), assumed)
        error = np.stack(turned(*(flow.at(x, y) - truth.at(x, y)), UP))
        off.append(error / np.sqrt(flow.variance_at(x, y)))
    assert 0.9 < np.std(off) < 1.1


def test_droplets_that_sediment_otherwise_than_said_show_it() -> None:
    """The relative error of Stokes' velocity is found, with its own error."""
    assumed = model()
    seen = seen_in(random_flow(assumed, 3), 120, 4, stokes_error=0.25)
    mean, variance = regress(seen, assumed).stokes_error
    assert abs(mean - 0.25) < 4 * np.sqrt(variance)
    assert np.sqrt(variance) < 0.02


def test_turning_vectors_and_back_changes_nothing() -> None:
    """For any direction against gravity."""
    rng = np.random.default_rng(0)
    vectors = rng.normal(size=(2, 5))
    for angle in (0.0, 1.0, 4.0):
        up = (np.cos(angle), np.sin(angle))
        np.testing.assert_allclose(unturned(*turned(*vectors, up), up), vectors, atol=1e-12)
