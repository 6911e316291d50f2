"""Velocities of droplets, the model of the flow they measure, and the normal equations of both."""

from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.spectrum import N_COMMON, Spectrum
from dropflow.tracking.probable.waves import Matrix, Waves, WavesAt


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
        return Observations(*(getattr(self, field.name)[which] for field in fields(self)))

    @classmethod
    def concatenate(cls, parts: "list[Observations]") -> Self:
        """All observations of `parts`."""
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


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

    @cached_property
    def directions(self) -> list[tuple[Column, Column]]:
        """Of the velocity of each wave, for each kind of wave."""
        return self.waves.directions(self.up, with_potential=self.with_potential)

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


def weights(observations: Observations, noise_um_s: float) -> Matrix:
    """One over the variance of each observation, across and along `up`, shape (2, n)."""
    noise = noise_um_s**2
    across = observations.weight / (observations.across_variance + noise)
    along = observations.weight / (observations.along_variance + noise)
    return np.stack([across, along])


def normal_equations(
    observations: Observations, points: WavesAt, model: Model, weight: Matrix
) -> tuple[Matrix, Column]:
    """Normal matrix and right hand side of the weighted least squares, without the prior.

    Parameters
    ----------
    observations : Observations
    points : WavesAt
        The model's waves where the observations are.
    model : Model
    weight : ndarray, float64, shape (2, n)
        Of each observation across and along `up`.
    """
    across, along = weight
    sinking = observations.sedimentation_um_s
    value_along = observations.along_um_s - model.factor_mean * sinking
    weighted = np.stack([across, along, along * sinking, across * observations.across_um_s, along * value_along])
    n_unknowns = len(model.prior)
    matrix, vector = np.zeros((n_unknowns, n_unknowns)), np.zeros(n_unknowns)
    vector[:N_COMMON] = weighted[3].sum(), weighted[4].sum(), weighted[4] @ sinking
    matrix[0, 0], matrix[1, 1], matrix[2, 2] = across.sum(), along.sum(), weighted[2] @ sinking
    matrix[1, 2] = matrix[2, 1] = weighted[2].sum()
    sums = points.vectors(weighted)
    products = points.matrices(weight)
    for kind, direction in enumerate(model.directions):
        for singles, block in zip((sums.real, sums.imag), model.waves_of(kind), strict=True):
            vector[block] = direction[0] * singles[3] + direction[1] * singles[4]
            for row in range(N_COMMON):
                matrix[row, block] = matrix[block, row] = direction[min(row, 1)] * singles[row]
        for other in range(kind + 1):
            _put_products(matrix, model, products, kind, other)
    return matrix, vector


def _put_products(
    matrix: Matrix, model: Model, products: list[tuple[Matrix, Matrix, Matrix]], kind: int, other: int
) -> None:
    """The blocks of the matrix in which waves of two kinds meet."""
    one, two = model.directions[kind], model.directions[other]
    outer = [np.outer(one[component], two[component]) for component in (0, 1)]
    cos_cos, cos_sin, sin_sin = (outer[0] * across + outer[1] * along for across, along in zip(*products, strict=True))
    sin_cos = outer[0] * products[0][1].T + outer[1] * products[1][1].T
    rows, columns = model.waves_of(kind), model.waves_of(other)
    for row_block, parts in zip(rows, ((cos_cos, cos_sin), (sin_cos, sin_sin)), strict=True):
        for column_block, part in zip(columns, parts, strict=True):
            matrix[row_block, column_block] = part
            matrix[column_block, row_block] = part.T
