"""The spectrum of a flow from the droplets themselves: the one under which their velocities are most probable."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.least_squares import Model, Observations, Sums, normal_equations, weights
from dropflow.tracking.probable.regression import covariance_of, solve
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.waves import Waves

_MOST_LATTICES = 3
_SAME_LENGTH = 0.25
"""A length that changed by less than this (in ln) does not need another lattice of waves."""
_STEP = 1e-4
_LEAST_WEIGHT = 1e-12
_NEGLIGIBLE_SHARE = 0.01
"""A flow with less of its energy in a potential is taken to have none."""
_USUAL_LENGTH_SHARE = 0.15
"""Of the frame, a correlation length that surprises nobody: the centre of a prior that spans an order of magnitude."""


@dataclass(frozen=True)
class _Prior:
    """Normal prior of each parameter; in logarithms, the share in log odds."""

    mean: Column
    std: Column

    def penalty(self, parameters: Column) -> tuple[float, Column]:
        off = (parameters - self.mean) / self.std
        return float(off @ off) / 2, np.asarray(off / self.std)


def estimate_spectrum(
    steps: list[Observations], grid: Grid, model: Model | None, up: Up, *, with_potential: bool, most_iterations: int
) -> Model:
    """The model of highest evidence for the observations of some steps, started from `model` if there is one.

    Parameters
    ----------
    steps : list of Observations
        Each the droplets of one step, independent of each other.
    grid : Grid
        For the size of the frame.
    model : Model or None
        Where to start; its error of the sedimentation's factor is kept.
    up : (float, float)
        Unit vector against gravity.
    with_potential : bool
        Whether to look for a part of the flow that has a divergence in the plane; without, twice as fast.
    most_iterations : int
        Of the climb to the highest evidence.

    Returns
    -------
    Model
        With waves that suit the length found.
    """
    prior = _prior_of(steps, grid)
    found = model or _first_guess(prior, grid, up)
    for _ in range(_MOST_LATTICES):
        start = replace(found, waves=Waves.over(grid, found.spectrum.length_px), with_potential=with_potential)
        spectrum = _climb(steps, start, prior, most_iterations)
        has_moved = abs(np.log(spectrum.length_px / start.spectrum.length_px)) > _SAME_LENGTH
        found = replace(start, spectrum=spectrum)
        if not has_moved:
            break
    has_potential = with_potential and found.spectrum.potential_share > _NEGLIGIBLE_SHARE
    return replace(found, with_potential=has_potential)


def _climb(steps: list[Observations], model: Model, prior: _Prior, most_iterations: int) -> Spectrum:
    def loss(parameters: Column) -> tuple[float, Column]:
        penalty, slope = prior.penalty(parameters)
        value, gradient = evidence(steps, model, parameters)
        return penalty - value, slope - gradient

    start = parameters_of(model.spectrum)
    low, high = prior.mean - 4 * prior.std, prior.mean + 4 * prior.std
    result = minimize(
        loss,
        np.clip(start, low, high),
        jac=True,
        method="L-BFGS-B",
        bounds=np.column_stack([low, high]),
        options={"maxiter": most_iterations, "ftol": 1e-5},
    )
    return _spectrum(np.asarray(result.x, np.float64))


def evidence(steps: list[Observations], model: Model, parameters: Column) -> tuple[float, Column]:
    """Logarithm of the evidence and its slope with each parameter."""
    at = replace(model, spectrum=_spectrum(parameters))
    value, gradient = 0.0, np.zeros(len(parameters))
    by_prior = np.zeros(len(at.prior))
    for step in steps:
        one, slope_prior, slope_noise = _evidence_of_step(step, at)
        value += one
        by_prior += slope_prior
        gradient[4] += slope_noise * 2 * at.spectrum.noise_um_s**2
    for index in range(4):
        shifted = parameters.copy()
        shifted[index] += _STEP
        change = replace(model, spectrum=_spectrum(shifted)).prior - at.prior
        gradient[index] = by_prior @ change / _STEP
    return value, gradient


def _evidence_of_step(step: Observations, model: Model) -> tuple[float, Column, float]:
    """Log evidence, its slope with the prior variance of each unknown, and with the variance of the noise."""
    points = model.waves.at(step.x_px, step.y_px)
    weight = weights(step, model.spectrum.noise_um_s)
    matrix, vector = normal_equations(Sums.over(step, points, weight), model)
    factor, whitened = solve(matrix, vector, model.prior)
    covariance = covariance_of(factor, model.prior)
    amplitudes = covariance @ vector
    value_along = step.along_um_s - model.factor_mean * step.sedimentation_um_s
    values = np.stack([step.across_um_s, value_along])
    noise = model.spectrum.noise_um_s**2
    log_noise = step.weight @ (np.log(step.across_variance + noise) + np.log(step.along_variance + noise))
    value = (whitened @ whitened - (weight * values**2).sum() - log_noise) / 2 - np.log(np.diag(factor)).sum()
    slope_prior = ((amplitudes**2 + np.diag(covariance)) / model.prior**2 - 1 / model.prior) / 2
    # The slope with the noise: squares of residuals and of the flow's error, weighted with the square of the weights.
    twice = weight**2 / np.maximum(step.weight, _LEAST_WEIGHT)
    matrix_2, vector_2 = normal_equations(Sums.over(step, points, twice), model)
    residual = (twice * values**2).sum() - 2 * amplitudes @ vector_2 + amplitudes @ matrix_2 @ amplitudes
    slope_noise = (residual + (covariance * matrix_2).sum() - weight.sum()) / 2
    return float(value), np.asarray(slope_prior), float(slope_noise)


def _spectrum(parameters: Column) -> Spectrum:
    rms, length, odds, broadness, noise = parameters.tolist()
    share = 1 / (1 + np.exp(-odds))
    return Spectrum(
        float(np.exp(rms)), float(np.exp(length)), float(share), float(np.exp(broadness)), float(np.exp(noise))
    )


def parameters_of(spectrum: Spectrum) -> Column:
    odds = np.log(spectrum.potential_share / (1 - spectrum.potential_share))
    logs = np.log([spectrum.rms_um_s, spectrum.length_px, spectrum.broadness, spectrum.noise_um_s])
    return np.array([logs[0], logs[1], odds, logs[2], logs[3]])


def _prior_of(steps: list[Observations], grid: Grid) -> _Prior:
    """Weak expectations from the size of the frame and of the velocities."""
    speed = np.concatenate([np.concatenate([step.across_um_s, step.along_um_s]) for step in steps])
    known = np.concatenate([np.concatenate([step.across_variance, step.along_variance]) for step in steps])
    rms = max(float(np.sqrt(np.median(speed**2) * 2)), float(np.sqrt(np.median(known))), 1e-9)
    length = _USUAL_LENGTH_SHARE * np.sqrt(grid.height_px * grid.width_px)
    mean = np.array([np.log(rms), np.log(length), -3.0, np.log(0.03), np.log(0.1 * rms)])
    return _Prior(mean, np.array([1.0, 0.8, 1.5, 1.2, 1.0]))


def _first_guess(prior: _Prior, grid: Grid, up: Up) -> Model:
    spectrum = _spectrum(prior.mean)
    waves = Waves.over(grid, spectrum.length_px)
    return Model(waves, spectrum, up, with_potential=True, factor_mean=0.0, factor_variance=0.3**2)
