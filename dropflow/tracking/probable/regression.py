"""The flow of one step from the velocities of droplets: Gaussian-process regression in a basis of waves.

The flow is a Gaussian random field with a given spectrum (`dropflow.tracking.probable.spectrum`); droplets measure it
where they are, each with its own error. In a basis of m waves the most probable flow and its error cost m^3 + n m for
n droplets instead of n^3, for all sums over droplets come from Fourier sums on the lattice of waves.
"""

from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np
import numpy.typing as npt
from scipy.linalg import blas, lapack

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.directions import unturned
from dropflow.tracking.probable.least_squares import Model, Observations, Sums, normal_equations, weights
from dropflow.tracking.probable.spectrum import N_COMMON
from dropflow.tracking.probable.waves import Complex, Indices, Matrix, fold

_MOST_SINCE = 3
"""Flows that share an error are at most so many steps apart."""
_SAME_WEIGHT = 0.1
"""By which part the observations may differ in weight."""


@dataclass(frozen=True)
class WaveFlow:
    """The most probable flow, and how sure it is."""

    model: Model
    amplitudes: Column
    """Of each unknown, in the order of `Model.prior`."""
    variance: Complex
    """Of the velocity across `up` and along it, shape (2, *Waves.series_shape): a sum of squares of waves, hence of
    waves twice as fine, whose amplitudes these are."""
    stokes_variance: float
    """Of the error of Stokes' factor."""
    weight: float
    """Of all observations when `variance` was reckoned."""
    n_since: int
    """Flows before this one whose `variance` this has been; 0 where it is its own."""

    @property
    def stokes_error(self) -> tuple[float, float]:
        """Relative error of Stokes' velocity that these droplets show, and its variance."""
        return float(self.amplitudes[2]) + self.model.factor_mean, self.stokes_variance

    @cached_property
    def _folded_velocity(self) -> Matrix:
        """Of the waves of the velocity along x and y."""
        amplitudes = np.zeros((2, len(self.model.waves)), np.complex128)
        for kind, directions in enumerate(self.model.directions_of_kinds):
            cosines, sines = self.model.waves_of(kind)
            amplitudes += directions * (self.amplitudes[cosines] - 1j * self.amplitudes[sines])
        series = self.model.waves.series_of(amplitudes, 1)
        series[:, self.model.waves.n_x, 0] += self.amplitudes[:2]
        across, along = np.split(fold(series), 2)
        return np.concatenate(unturned(across, along, self.model.up))

    @cached_property
    def _folded_variance(self) -> Matrix:
        return fold(self.variance)

    def at(self, x_px: Column, y_px: Column) -> Column:
        """Velocity along x and y at points, shape (2, n), um/s."""
        return self.model.waves.evaluate_at(self._folded_velocity, x_px, y_px)

    def variance_at(self, x_px: Column, y_px: Column) -> Column:
        """Variance of the error across `up` and along it at points, shape (2, n), (um/s)^2."""
        points = self.model.waves.at(x_px, y_px, 2)
        return np.asarray(np.maximum(points.evaluate(self._folded_variance, 2), 0.0))

    def on_grid(self, x_px: Column, y_px: Column) -> tuple[Matrix, Matrix]:
        """Both where columns at `x_px` cross rows at `y_px`, shape (2, n_rows, n_columns)."""
        points = self.model.waves.at(x_px, y_px, 2)
        variance = points.evaluate_on_grid(self._folded_variance, 2)
        return points.evaluate_on_grid(self._folded_velocity, 1), np.asarray(np.maximum(variance, 0.0))


def regress(observations: Observations, model: Model, *, like: WaveFlow | None = None) -> WaveFlow:
    """The flow that is most probable after the observations.

    The field of its error costs more than the flow. It changes as slowly as the droplets' number and places do: where
    a flow of a step or two before is given (`like`) and was seen by as many, its error is taken.
    """
    return regress_sums(sums_of(observations, model), model, like=like)


def sums_of(observations: Observations, model: Model) -> Sums:
    """The sums over observations, with the weights that they have under a model."""
    points = model.waves.at(observations.x_px, observations.y_px, 2)
    return Sums.over(observations, points, weights(observations, model.spectrum.noise_um_s))


def regress_sums(sums: Sums, model: Model, *, like: WaveFlow | None = None) -> WaveFlow:
    """As `regress`."""
    matrix, vector = normal_equations(sums, model)
    factor, whitened = solve(matrix, vector)
    half_way, _ = lapack.dtrtrs(factor, whitened, lower=1, trans=1)
    amplitudes = np.asarray(np.sqrt(model.prior) * half_way)
    of_factor, _ = lapack.dtrtrs(factor, np.eye(N_COMMON, len(vector))[2], lower=1)
    stokes_variance = float(of_factor @ of_factor * model.prior[2])
    weight = float(sums.common[-1])
    if like is not None and _is_as_well_known(like, model, weight):
        return WaveFlow(model, amplitudes, like.variance, stokes_variance, like.weight, like.n_since + 1)
    return WaveFlow(model, amplitudes, variance_series(factor, model), stokes_variance, weight, 0)


def _is_as_well_known(flow: WaveFlow, model: Model, weight: float) -> bool:
    """Whether the error of another flow will do."""
    is_same = (flow.model.waves, flow.model.spectrum) == (model.waves, model.spectrum)
    is_same &= flow.model.with_potential == model.with_potential
    return is_same and flow.n_since < _MOST_SINCE and abs(weight - flow.weight) < _SAME_WEIGHT * flow.weight


def solve(matrix: Matrix, vector: Column) -> tuple[Matrix, Column]:
    """Cholesky factor of I + matrix, as `normal_equations` gives it, in its place, and its inverse times the vector."""
    matrix.flat[:: len(matrix) + 1] += 1
    # The transpose of the upper triangle is the lower one, which lies in memory as LAPACK wants it.
    factor, _ = lapack.dpotrf(matrix.T, lower=1, overwrite_a=1, clean=0)
    whitened, _ = lapack.dtrtrs(factor, vector, lower=1)
    return factor, np.asarray(whitened)


def variance_series(factor: Matrix, model: Model) -> Complex:
    """`WaveFlow.variance` from the factor that `solve` gives.

    The factor was found in double precision; of its inverse seven digits are enough, at half the cost.
    """
    unit = np.eye(len(factor), dtype=np.float32, order="F")
    whitening = blas.strsm(1.0, factor.astype(np.float32), unit, lower=1, overwrite_b=1)
    inverse, _ = lapack.slauum(whitening, lower=1, overwrite_c=1)  # `spotri` would take half as long again
    root = np.sqrt(model.prior).astype(np.float32)
    series = np.zeros((2, *model.waves.series_shape), np.complex128)
    directions = model.directions_of_kinds
    # In memory the lower triangle of LAPACK's matrix is the upper one of its transpose.
    _add_squares(series.reshape(2, -1), inverse.T, root, *model.waves.pairs, directions)
    for component in (0, 1):
        with_mean = inverse[:, component] * root * root[component]
        single = np.zeros(len(model.waves), np.complex128)
        for kind, of_kind in enumerate(directions):
            cosines, sines = model.waves_of(kind)
            single += 2 * of_kind[component] * (with_mean[cosines] - 1j * with_mean[sines])
        series[component] += model.waves.series_of(single, 2)
        series[component, 2 * model.waves.n_x, 0] += with_mean[component]
    return series


@numba.njit(cache=True)
def _add_squares(
    series: Complex,
    upper: npt.NDArray[np.float32],
    root: npt.NDArray[np.float32],
    minus: Indices,
    sign: Column,
    plus: Indices,
    directions: Matrix,
) -> None:  # pragma: no cover - compiled
    """Add up the squares of all waves under their covariance, of which the upper triangle is given without `root`.

    Only pairs above the diagonal are looked at, and count twice: of one wave cosine with cosine, sine with sine and
    one of the two mixed pairs; of two waves all four.
    """
    n_kinds, _, n_waves = directions.shape
    for one in range(n_kinds):
        for i in range(n_waves):
            cosine = N_COMMON + 2 * one * n_waves + i
            sine = cosine + n_waves
            for two in range(one, n_kinds):
                for j in range(i if two == one else 0, n_waves):
                    other_cosine = N_COMMON + 2 * two * n_waves + j
                    other_sine = other_cosine + n_waves
                    is_same = cosine == other_cosine
                    times = 1 if is_same else 2
                    both = times * upper[cosine, other_cosine] * root[cosine] * root[other_cosine]
                    neither = times * upper[sine, other_sine] * root[sine] * root[other_sine]
                    mixed = 2 * upper[cosine, other_sine] * root[cosine] * root[other_sine]
                    turned = np.float32(0)
                    if not is_same:
                        low, high = (other_cosine, sine) if one == two else (sine, other_cosine)
                        turned = 2 * upper[low, high] * root[low] * root[high]
                    of_difference = complex(both + neither, sign[i, j] * (mixed - turned)) / 2
                    of_sum = complex(both - neither, -(mixed + turned)) / 2
                    for component in range(2):
                        direction = directions[one, component, i] * directions[two, component, j]
                        series[component, minus[i, j]] += direction * of_difference
                        series[component, plus[i, j]] += direction * of_sum
