"""Velocities of droplets, the model of the flow they measure, and the normal equations of both."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

import numba
import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.spectrum import N_COMMON, Spectrum
from dropflow.tracking.probable.waves import Complex, Indices, Matrix, Waves, WavesAt


@dataclass(frozen=True)
class Observations:
    """Velocities of droplets over a step, in parts across `up` and along it; each attribute of shape (n,)."""

    x_px: Column
    """In the middle of the step."""
    y_px: Column
    across_um_s: Column
    along_um_s: Column
    """Without the sedimentation."""
    sedimentation_um_s: Column
    across_variance: Column
    """Of the known errors, (um/s)^2."""
    along_variance: Column
    weight: Column
    """0 to 1: how far the observation counts."""

    def __len__(self) -> int:
        return len(self.x_px)

    def __getitem__(self, which: npt.NDArray[np.bool_] | slice) -> "Observations":
        return Observations(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @classmethod
    def concatenate(cls, parts: "list[Observations]") -> Self:
        """All observations of `parts`."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in cls.__dataclass_fields__))


@dataclass(frozen=True)
class Model:
    """What is assumed of the flow before droplets are seen."""

    waves: Waves
    spectrum: Spectrum
    up: Up
    with_potential: bool
    factor_mean: float
    """Of the relative error of Stokes' velocity: -0.3 where droplets sediment 30 % slower than the material says."""
    factor_variance: float

    @property
    def directions_of_kinds(self) -> Matrix:
        """Of the velocity of each wave, for each kind of wave, shape (n_kinds, 2, n_waves)."""
        return _directions(self.waves, self.up, self.with_potential)

    @cached_property
    def prior(self) -> Column:
        """Variance of each unknown: mean across and along `up`, error of Stokes' factor, waves of each kind."""
        return self.spectrum.variances(
            self.waves, with_potential=self.with_potential, factor_variance=self.factor_variance
        )

    def waves_of(self, kind: int) -> tuple[slice, slice]:
        """Where the cosines and sines of a kind stand among the unknowns."""
        n_waves = len(self.waves)
        first = N_COMMON + 2 * kind * n_waves
        return slice(first, first + n_waves), slice(first + n_waves, first + 2 * n_waves)


@lru_cache(maxsize=8)
def _directions(waves: Waves, up: Up, with_potential: bool) -> Matrix:
    """The same in every step, whereas the model of each differs in what is known of Stokes' factor."""
    return np.array(waves.directions(up, with_potential=with_potential))


def weights(observations: Observations, noise_um_s: float) -> Matrix:
    """One over the variance of each observation, across and along `up`, shape (2, n)."""
    noise = noise_um_s**2
    across = observations.weight / (observations.across_variance + noise)
    along = observations.weight / (observations.along_variance + noise)
    return np.stack([across, along])


@dataclass(frozen=True)
class Sums:
    """All that least squares need to know of observations; that of several is the sum of theirs."""

    pairs: Complex
    """As `WavesAt.sums_of_pairs` of the weights across `up` and along it."""
    singles: Complex
    """Sums over the waves of weight along * sinking, weight * velocity across, weight * velocity along."""
    common: Column
    """Sums of the weights across and along, of weight along times sinking and times its square, of weights times
    velocities across and along, of weight along times velocity times sinking, and of `Observations.weight`."""

    def __add__(self, other: "Sums") -> "Sums":
        return Sums(self.pairs + other.pairs, self.singles + other.singles, self.common + other.common)

    @classmethod
    def over(cls, observations: Observations, points: WavesAt, weight: Matrix) -> Self:
        """Of observations at some points, their weights across `up` and along it given apart, shape (2, n)."""
        across, along = weight
        sinking = observations.sedimentation_um_s
        weighted = np.stack([along * sinking, across * observations.across_um_s, along * observations.along_um_s])
        both = [across.sum(), along.sum(), weighted[0].sum(), weighted[0] @ sinking]
        common = [*both, weighted[1].sum(), weighted[2].sum(), weighted[2] @ sinking, observations.weight.sum()]
        return cls(points.sums_of_pairs(weight), points.vectors(weighted), np.array(common))


def normal_equations(sums: Sums, model: Model) -> tuple[Matrix, Column]:
    """Normal matrix and right hand side of the weighted least squares, without the prior.

    Unknowns are in units of their prior standard deviation. Of the matrix only the upper triangle is filled in, which
    in memory is the lower one of LAPACK's.
    """
    root, error = np.sqrt(model.prior), model.factor_mean
    matrix, vector = np.zeros((len(root), len(root))), np.zeros(len(root))
    across, along, sinking, squares, value_across, value_along, value_sinking, _ = sums.common.tolist()
    vector[:N_COMMON] = value_across, value_along - error * sinking, value_sinking - error * squares
    matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[1, 2] = across, along, squares, sinking
    ones = sums.pairs[:, model.waves.single_among_pairs]
    values = np.stack([sums.singles[1], sums.singles[2] - error * sums.singles[0]])
    rows = np.concatenate([ones, sums.singles[:1]])
    for kind, direction in enumerate(model.directions_of_kinds):
        of_waves, of_rows = (direction * values).sum(axis=0), direction[[0, 1, 1]] * rows
        cosines, sines = model.waves_of(kind)
        vector[cosines], vector[sines] = of_waves.real, of_waves.imag
        matrix[:N_COMMON, cosines], matrix[:N_COMMON, sines] = of_rows.real, of_rows.imag
    matrix[:N_COMMON] *= root[:N_COMMON, None] * root
    _put_products(matrix, root, sums.pairs, *model.waves.pairs, model.directions_of_kinds)
    return matrix, root * vector


@numba.njit(cache=True)
def _put_products(
    matrix: Matrix, root: Column, sums: Complex, minus: Indices, sign: Column, plus: Indices, directions: Matrix
) -> None:  # pragma: no cover - compiled
    """Fill in the part of the normal matrix in which waves meet waves, above the diagonal.

    `sums` has a row for the weights across `up` and one for those along it; see `Waves.pairs`.
    """
    n_kinds, _, n_waves = directions.shape
    for one in range(n_kinds):
        for i in range(n_waves):
            row = N_COMMON + 2 * one * n_waves + i
            for two in range(one, n_kinds):
                for j in range(n_waves):
                    column = N_COMMON + 2 * two * n_waves + j
                    across = directions[one, 0, i] * directions[two, 0, j]
                    along = directions[one, 1, i] * directions[two, 1, j]
                    difference = across * sums[0, minus[i, j]] + along * sums[1, minus[i, j]]
                    total = across * sums[0, plus[i, j]] + along * sums[1, plus[i, j]]
                    turned = sign[i, j] * difference.imag
                    scale = root[row] * root[column] / 2  # sines have the prior of their cosines
                    matrix[row, column + n_waves] = scale * (total.imag - turned)
                    if column >= row:
                        matrix[row, column] = scale * (difference.real + total.real)
                        matrix[row + n_waves, column + n_waves] = scale * (difference.real - total.real)
                    if two > one:
                        matrix[row + n_waves, column] = scale * (total.imag + turned)
