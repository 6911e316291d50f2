"""A smooth flow as a sum of plane waves, and the sums over droplets that fit it in time linear in their number."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column, Grid

Complex = npt.NDArray[np.complex128]
Matrix = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

_MARGIN_LENGTHS = 2.5
"""The box of the waves is larger than the frame by this many correlation lengths, so that the far side of the frame
does not feel the near one through the period."""
_LEAST_BOX_LENGTHS = 6.0
"""A box is at least this many correlation lengths wide: its waves must be closer together than the spectrum is wide."""
_FINEST_WAVE = 4.5
"""Waves up to this over the correlation length: what is shorter has 0.05 % of the energy of a Gaussian spectrum."""
_MOST_WAVES = 160


@dataclass(frozen=True)
class Waves:
    """Plane waves exp(i k x) with k on a lattice: periodic in a box of `width_px` x `height_px` around the frame.

    Of k and -k only one is kept. Places are in px, k in 1/px.
    """

    width_px: float
    height_px: float
    n_x: int
    """Waves along x have indices -n_x .. n_x."""
    n_y: int

    @classmethod
    def over(cls, grid: Grid, length_px: float) -> Self:
        """Waves fine enough for a flow with this correlation length, as far as their number allows."""
        margin = _MARGIN_LENGTHS * length_px
        width = max(grid.width_px + margin, _LEAST_BOX_LENGTHS * length_px)
        height = max(grid.height_px + margin, _LEAST_BOX_LENGTHS * length_px)
        # The number of waves is a quarter ellipse's area twice: pi/2 n_x n_y.
        affordable = np.sqrt(_MOST_WAVES * 8 * np.pi / (width * height))
        finest = min(_FINEST_WAVE / length_px, affordable)
        n_x, n_y = (max(1, int(finest * size / (2 * np.pi))) for size in (width, height))
        return cls(width, height, n_x, n_y)

    @cached_property
    def index(self) -> tuple[Indices, Indices]:
        """Indices along x and y of the waves, each of shape (n,): a half plane of an ellipse, without zero."""
        i_x, i_y = np.meshgrid(np.arange(-self.n_x, self.n_x + 1), np.arange(self.n_y + 1), indexing="ij")
        is_half = (i_y > 0) | (i_x > 0)
        is_inside = (i_x / (self.n_x + 0.5)) ** 2 + (i_y / (self.n_y + 0.5)) ** 2 <= 1
        return i_x[is_half & is_inside], i_y[is_half & is_inside]

    @cached_property
    def k_per_px(self) -> tuple[Column, Column]:
        """Wave vectors along x and y."""
        i_x, i_y = self.index
        return np.asarray(2 * np.pi / self.width_px * i_x), np.asarray(2 * np.pi / self.height_px * i_y)

    @cached_property
    def modulus_per_px(self) -> Column:
        """Lengths of the wave vectors."""
        return np.hypot(*self.k_per_px)

    def __len__(self) -> int:
        return len(self.index[0])

    def directions(self, up: tuple[float, float], *, with_potential: bool) -> list[tuple[Column, Column]]:
        """Unit vectors of the velocity of each wave, as parts across and along `up`.

        First those of waves without divergence (velocity across k), then, if wanted, those of a potential (along k).
        """
        k_x, k_y = (k / self.modulus_per_px for k in self.k_per_px)
        kinds = [(k_y, -k_x), (k_x, k_y)] if with_potential else [(k_y, -k_x)]
        return [(-up[1] * x + up[0] * y, up[0] * x + up[1] * y) for x, y in kinds]

    def at(self, x_px: Column, y_px: Column) -> "WavesAt":
        """The waves at points."""
        turn_x, turn_y = np.exp(2j * np.pi / self.width_px * x_px), np.exp(2j * np.pi / self.height_px * y_px)
        return WavesAt(self, turn_x, turn_y)

    @cached_property
    def _single(self) -> Indices:
        """Where k stands in an array over indices -n_x .. n_x, 0 .. n_y."""
        i_x, i_y = self.index
        return (i_x + self.n_x) * (self.n_y + 1) + i_y

    @cached_property
    def _pairs(self) -> tuple[Indices, Column, Indices]:
        """Where k - k' and k + k' stand in an array over indices -2 n_x .. 2 n_x, 0 .. 2 n_y.

        Waves of negative index along y are the conjugates of their opposites: for these the sign is -1.
        """
        i_x, i_y = self.index
        row, middle = 2 * self.n_y + 1, 2 * self.n_x
        x_minus, y_minus = i_x[:, None] - i_x, i_y[:, None] - i_y
        sign = np.where(y_minus < 0, -1, 1)
        minus = (sign * x_minus + middle) * row + np.abs(y_minus)
        plus = (i_x[:, None] + i_x + middle) * row + i_y[:, None] + i_y
        return minus, sign.astype(np.float64), plus

    def series_of(self, amplitudes: Complex) -> Complex:
        """Amplitudes of the waves, in the array over indices -2 n_x .. 2 n_x, 0 .. 2 n_y of `evaluate_series`."""
        i_x, i_y = self.index
        series = np.zeros((4 * self.n_x + 1, 2 * self.n_y + 1), np.complex128)
        series[i_x + 2 * self.n_x, i_y] = amplitudes
        return series

    def series_of_squares(self, cos_cos: Matrix, cos_sin: Matrix, sin_sin: Matrix) -> Complex:
        """The sum of a cos cos' + 2 b cos sin' + d sin sin' over all pairs of waves, as amplitudes of single waves."""
        minus, sign, plus = self._pairs
        shape = (4 * self.n_x + 1, 2 * self.n_y + 1)
        real = _gathered(minus, (cos_cos + sin_sin) / 2, shape) + _gathered(plus, (cos_cos - sin_sin) / 2, shape)
        imaginary = _gathered(minus, sign * cos_sin, shape) - _gathered(plus, cos_sin, shape)
        return np.asarray(real + 1j * imaginary)


@dataclass(frozen=True)
class WavesAt:
    """The waves at n points; each is a product of a wave in x and one in y."""

    waves: Waves
    turn_x: Complex
    """exp(i x) of the slowest wave along x, shape (n,)."""
    turn_y: Complex

    @cached_property
    def _along_x(self) -> Complex:
        """Indices -2 n_x .. 2 n_x, shape (4 n_x + 1, n)."""
        return _both_signs(_powers(self.turn_x, 2 * self.waves.n_x))

    @cached_property
    def _along_y(self) -> Complex:
        """Indices 0 .. 2 n_y, shape (2 n_y + 1, n)."""
        return _powers(self.turn_y, 2 * self.waves.n_y)

    def vectors(self, weights: Matrix) -> Complex:
        """Sums of weights * exp(i k x) over the points: weights of shape (m, n), sums of shape (m, n_waves)."""
        n_x, n_y = self.waves.n_x, self.waves.n_y
        sums = self._sums(weights, self._along_x[n_x : 3 * n_x + 1], self._along_y[: n_y + 1])
        return np.asarray(sums[:, self.waves._single])

    def matrices(self, weights: Matrix) -> list[tuple[Matrix, Matrix, Matrix]]:
        """Sums of weights times cos cos', cos sin' and sin sin', each of shape (n_waves, n_waves), for each row.

        Products of waves are waves of sum and difference, so that all entries come from a few sums.
        """
        minus, sign, plus = self.waves._pairs
        matrices = []
        for sums in self._sums(weights, self._along_x, self._along_y):
            difference, total = sums[minus], sums[plus]
            real, imaginary = difference.real, sign * difference.imag
            matrices.append(((real + total.real) / 2, (total.imag - imaginary) / 2, (real - total.real) / 2))
        return matrices

    def evaluate(self, cosines: Matrix, sines: Matrix) -> Matrix:
        """Sums of cosines * cos(k x) + sines * sin(k x): amplitudes of shape (m, n_waves), sums of shape (m, n)."""
        i_x, i_y = self.waves.index
        n_x, n_y = self.waves.n_x, self.waves.n_y
        table = np.zeros((len(cosines), n_y + 1, 2 * n_x + 1), np.complex128)
        table[:, i_y, i_x + n_x] = cosines - 1j * sines
        along_x = _both_signs(_powers(self.turn_x, n_x))
        along_y = _powers(self.turn_y, n_y)
        rows = (table.reshape(-1, 2 * n_x + 1) @ along_x).reshape(len(cosines), n_y + 1, -1)
        return np.asarray((rows * along_y).sum(axis=1).real)

    def evaluate_series(self, series: Complex) -> Matrix:
        """Real parts of the sums of amplitude * exp(i k x) over waves up to twice as fine, shape (m, n)."""
        rows = np.tensordot(series, self._along_x, axes=([1], [0]))
        return np.asarray((rows * self._along_y).sum(axis=1).real)

    def _sums(self, weights: Matrix, along_x: Complex, along_y: Complex) -> Complex:
        weighted = (weights[:, None, :] * along_x).reshape(-1, weights.shape[1])
        return np.asarray((weighted @ along_y.T).reshape(len(weights), -1))


def _gathered(place: Indices, values: Matrix, shape: tuple[int, int]) -> Matrix:
    """Values added up at flat places of an array."""
    return np.asarray(np.bincount(place.ravel(), values.ravel(), shape[0] * shape[1]).reshape(shape), np.float64)


def _powers(factor: Complex, greatest: int) -> Complex:
    """Powers 0 .. greatest of numbers on the unit circle, shape (greatest + 1, n)."""
    powers = np.empty((greatest + 1, len(factor)), np.complex128)
    powers[0] = 1
    for power in range(1, greatest + 1):
        np.multiply(powers[power - 1], factor, out=powers[power])
    return powers


def _both_signs(powers: Complex) -> Complex:
    """Powers -greatest .. greatest."""
    return np.concatenate([powers[:0:-1].conj(), powers])
