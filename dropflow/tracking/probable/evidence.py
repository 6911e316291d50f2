"""How probable the velocities of droplets are under a spectrum of the flow, its slope, and how sharply it bends."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lapack

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.least_squares import Model, Observations, Sums, normal_equations, weights
from dropflow.tracking.probable.regression import solve
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.waves import Matrix

N_PARAMETERS = 5
_NOISE = 4
"""Index of the noise among the parameters; those before it make the prior of the unknowns."""
_STEP = 1e-4
_LEAST_WEIGHT = 1e-12


@dataclass(frozen=True)
class Evidence:
    """Of some parameters (`parameters_of`); sums over steps are sums of these."""

    value: float
    """Logarithm, up to a constant."""
    slope: Column
    """With each parameter, shape (5,)."""
    information: Matrix
    """Fisher's: how sharply the value bends down around its top, on average; shape (5, 5)."""

    def __add__(self, other: "Evidence") -> "Evidence":
        return Evidence(self.value + other.value, self.slope + other.slope, self.information + other.information)


def evidence(steps: list[Observations], model: Model, parameters: Column) -> Evidence:
    """Of steps that are independent of each other, under `model` with other parameters of its spectrum."""
    at = replace(model, spectrum=spectrum_of(parameters))
    log_slopes = np.empty((_NOISE, len(at.prior)))
    for index in range(_NOISE):
        shifted = parameters.copy()
        shifted[index] += _STEP
        log_slopes[index] = np.log(replace(model, spectrum=spectrum_of(shifted)).prior / at.prior) / _STEP
    first, *others = (_of_step(step, at, log_slopes) for step in steps)
    return sum(others, start=first)


def _of_step(step: Observations, model: Model, log_slopes: Matrix) -> Evidence:
    """`log_slopes` are those of the logarithm of the prior with the parameters that make it."""
    points = model.waves.at(step.x_px, step.y_px, 2)
    weight = weights(step, model.spectrum.noise_um_s)
    matrix, vector = normal_equations(Sums.over(step, points, weight), model)
    factor, whitened = solve(matrix, vector)
    amplitudes, _ = lapack.dtrtrs(factor, whitened, lower=1, trans=1)  # in units of the prior
    value_along = step.along_um_s - model.factor_mean * step.sedimentation_um_s
    values = np.stack([step.across_um_s, value_along])
    noise = model.spectrum.noise_um_s**2
    log_noise = step.weight @ (np.log(step.across_variance + noise) + np.log(step.along_variance + noise))
    value = (whitened @ whitened - (weight * values**2).sum() - log_noise) / 2 - np.log(np.diag(factor)).sum()
    # The slope with the noise: squares of residuals and of the flow's error, weighted with the square of the weights.
    twice = weight**2 / np.maximum(step.weight, _LEAST_WEIGHT)
    matrix_2, vector_2 = normal_equations(Sums.over(step, points, twice), model)
    # Of both matrices the upper triangle is given: what is off the diagonal counts twice.
    covariance = lapack.dpotri(factor, lower=1, overwrite_c=1)[0].T
    diagonal, diagonal_2 = np.diag(covariance), np.diag(matrix_2)
    of_flow = 2 * (matrix_2 @ amplitudes - vector_2) - diagonal_2 * amplitudes
    residual = (twice * values**2).sum() + amplitudes @ of_flow
    spread = 2 * np.vdot(covariance, matrix_2) - diagonal @ diagonal_2
    slope_noise = (residual + spread - weight.sum()) / 2
    slope_prior = log_slopes @ (amplitudes**2 + diagonal - 1) / 2
    per_log = 2 * noise
    share = per_log * float(twice.sum() / max(weight.sum(), _LEAST_WEIGHT))
    return Evidence(
        float(value),
        np.append(slope_prior, slope_noise * per_log),
        _information(covariance, log_slopes, share, 2 * len(step)),
    )


def _information(covariance: Matrix, log_slopes: Matrix, noise_share: float, n_values: int) -> Matrix:
    """Half the trace of K^-1 dK K^-1 dK', K being the covariance of all velocities.

    All observations are taken to have the same share of noise in their variance: it decides how fast the top is found,
    not where it is. Of `covariance` the upper triangle is given.
    """
    squares, diagonal = covariance**2, np.diag(covariance)
    information = np.empty((N_PARAMETERS, N_PARAMETERS))
    # Slopes times the squares of 1 - covariance, element by element, times slopes.
    half = log_slopes @ squares @ log_slopes.T
    information[:_NOISE, :_NOISE] = half + half.T + log_slopes * (1 - 2 * diagonal - diagonal**2) @ log_slopes.T
    of_rows = squares.sum(axis=0) + squares.sum(axis=1) - diagonal**2
    with_noise = noise_share * (log_slopes @ (diagonal - of_rows))
    information[_NOISE, :_NOISE] = information[:_NOISE, _NOISE] = with_noise
    information[_NOISE, _NOISE] = noise_share**2 * max(n_values - len(squares) + of_rows.sum(), 1.0)
    return information / 2


def spectrum_of(parameters: Column) -> Spectrum:
    """The spectrum that `parameters_of` was given."""
    rms, length, odds, broadness, noise = parameters.tolist()
    share = 1 / (1 + np.exp(-odds))
    return Spectrum(
        float(np.exp(rms)), float(np.exp(length)), float(share), float(np.exp(broadness)), float(np.exp(noise))
    )


def parameters_of(spectrum: Spectrum) -> Column:
    """Logarithms, and log odds of the share of the potential, shape (5,); the noise stands last."""
    odds = np.log(spectrum.potential_share / (1 - spectrum.potential_share))
    logs = np.log([spectrum.rms_um_s, spectrum.length_px, spectrum.broadness, spectrum.noise_um_s])
    return np.array([logs[0], logs[1], odds, logs[2], logs[3]])
