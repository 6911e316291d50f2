"""The flow of one step from the velocities of droplets: Gaussian-process regression in a basis of waves.

The flow is a Gaussian random field with a given spectrum (`dropflow.tracking.probable.spectrum`); droplets measure it
where they are, each with its own error. In a basis of m waves the most probable flow and its error cost m^3 + n m for
n droplets instead of n^3, for all sums over droplets come from Fourier sums on the lattice of waves.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.directions import unturned
from dropflow.tracking.probable.least_squares import Model, Observations, normal_equations, weights
from dropflow.tracking.probable.waves import Complex, Matrix


@dataclass(frozen=True)
class WaveFlow:
    """The most probable flow, and how sure it is."""

    model: Model
    amplitudes: Column
    """Of each unknown, in the order of `Model.prior`."""
    factor: Matrix
    """Lower Cholesky factor of I + sqrt(prior) A sqrt(prior), A the normal matrix of the observations."""

    @cached_property
    def covariance(self) -> Matrix:
        """Of the errors of the amplitudes."""
        return covariance_of(self.factor, self.model.prior)

    @property
    def stokes_error(self) -> tuple[float, float]:
        """Relative error of Stokes' velocity that these droplets show, and its variance."""
        return float(self.amplitudes[2]) + self.model.factor_mean, float(self.covariance[2, 2])

    def at(self, x_px: Column, y_px: Column) -> Column:
        """Velocity along x and y at points, shape (2, n), um/s."""
        points = self.model.waves.at(x_px, y_px)
        cosines, sines = np.zeros((2, 2, len(self.model.waves)))
        for kind, directions in enumerate(self.model.directions):
            of_cosines, of_sines = (self.amplitudes[block] for block in self.model.waves_of(kind))
            cosines += np.stack(directions) * of_cosines
            sines += np.stack(directions) * of_sines
        across, along = points.evaluate(cosines, sines) + self.amplitudes[:2, None]
        return unturned(across, along, self.model.up)

    def variance_at(self, x_px: Column, y_px: Column) -> Column:
        """Variance of the error across `up` and along it at points, shape (2, n), (um/s)^2."""
        variance = self.model.waves.at(x_px, y_px).evaluate_series(self._variance_series)
        return np.asarray(np.maximum(variance, 0.0))

    @cached_property
    def _variance_series(self) -> Complex:
        """The variance is a sum of squares of waves, hence of waves twice as fine: their amplitudes."""
        waves = self.model.waves
        series = np.zeros((2, 4 * waves.n_x + 1, 2 * waves.n_y + 1), np.complex128)
        for component in (0, 1):
            series[component] = self._squares(component)
        return series

    def _squares(self, component: int) -> Complex:
        """The series of the variance across `up` (0) or along it (1)."""
        model, n_waves = self.model, len(self.model.waves)
        cos_cos, cos_sin, sin_sin = np.zeros((3, n_waves, n_waves))
        single = np.zeros(n_waves, np.complex128)
        for kind, directions in enumerate(model.directions):
            one, (cosines, sines) = directions[component], model.waves_of(kind)
            with_mean = self.covariance[component]
            single += 2 * one * (with_mean[cosines] - 1j * with_mean[sines])
            for other, other_directions in enumerate(model.directions):
                two, (other_cosines, other_sines) = other_directions[component], model.waves_of(other)
                outer = one[:, None] * two
                cos_cos += outer * self.covariance[cosines, other_cosines]
                cos_sin += outer * self.covariance[cosines, other_sines]
                sin_sin += outer * self.covariance[sines, other_sines]
        series = model.waves.series_of_squares(cos_cos, cos_sin, sin_sin)
        series += model.waves.series_of(single)
        series[2 * model.waves.n_x, 0] += self.covariance[component, component]
        return series


def regress(observations: Observations, model: Model) -> WaveFlow:
    """The flow that is most probable after the observations."""
    points = model.waves.at(observations.x_px, observations.y_px)
    matrix, vector = normal_equations(observations, points, model, weights(observations, model.spectrum.noise_um_s))
    factor, whitened = solve(matrix, vector, model.prior)
    half_way, _ = lapack.dtrtrs(factor, whitened, lower=1, trans=1)
    return WaveFlow(model, np.asarray(np.sqrt(model.prior) * half_way), factor)


def solve(matrix: Matrix, vector: Column, prior: Column) -> tuple[Matrix, Column]:
    """Cholesky factor of I + sqrt(prior) matrix sqrt(prior), and its inverse times sqrt(prior) vector."""
    root = np.sqrt(prior)
    scaled = matrix * root[:, None] * root
    scaled[np.diag_indices_from(scaled)] += 1
    # The matrix is symmetric: its transpose lies in memory as LAPACK wants it.
    factor, _ = lapack.dpotrf(scaled.T, lower=1, overwrite_a=1)
    whitened, _ = lapack.dtrtrs(factor, root * vector, lower=1)
    return factor, np.asarray(whitened)


def covariance_of(factor: Matrix, prior: Column) -> Matrix:
    """Covariance of the unknowns after the observations, from the factor that `solve` gives."""
    lower, _ = lapack.dpotri(factor, lower=1)
    root = np.sqrt(prior)
    inverse = lower + lower.T
    inverse[np.diag_indices_from(inverse)] /= 2
    return np.asarray(inverse * root[:, None] * root)
