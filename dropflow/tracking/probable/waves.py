"""A smooth flow as a sum of plane waves, and the sums over droplets that fit it in time linear in their number."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numba
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
    def over(cls, grid: Grid, length_px: float, finest_per_px: float) -> Self:
        """For a flow with this correlation length, waves up to this wave number as far as their number allows."""
        margin = _MARGIN_LENGTHS * length_px
        width = max(grid.width_px + margin, _LEAST_BOX_LENGTHS * length_px)
        height = max(grid.height_px + margin, _LEAST_BOX_LENGTHS * length_px)
        # The number of waves is a quarter ellipse's area twice: pi/2 n_x n_y.
        affordable = np.sqrt(_MOST_WAVES * 8 * np.pi / (width * height))
        finest = min(finest_per_px, affordable)
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

    def at(self, x_px: Column, y_px: Column, fineness: int) -> "WavesAt":
        """The waves at points, and those up to so many times as fine."""
        return WavesAt(self, 2 * np.pi / self.width_px * x_px, 2 * np.pi / self.height_px * y_px, fineness)

    def evaluate_at(self, folded: Matrix, x_px: Column, y_px: Column) -> Matrix:
        """As `WavesAt.evaluate` of these waves themselves, at points that nothing else is wanted of."""
        angle_x, angle_y = 2 * np.pi / self.width_px * x_px, 2 * np.pi / self.height_px * y_px
        return _evaluated(folded, angle_x, angle_y, self.n_x, self.n_y)

    @cached_property
    def single(self) -> Indices:
        """Where k stands in an array over indices -n_x .. n_x, 0 .. n_y."""
        i_x, i_y = self.index
        return (i_x + self.n_x) * (self.n_y + 1) + i_y

    @cached_property
    def single_among_pairs(self) -> Indices:
        """Where k stands in an array over indices -2 n_x .. 2 n_x, 0 .. 2 n_y."""
        i_x, i_y = self.index
        return (i_x + 2 * self.n_x) * (2 * self.n_y + 1) + i_y

    @cached_property
    def pairs(self) -> tuple[Indices, Column, Indices]:
        """Where k - k' and k + k' stand in the flat array of `WavesAt.sums_of_pairs`, each of shape (n, n).

        Waves of negative index along y are the conjugates of their opposites: for these the sign is -1.
        """
        i_x, i_y = self.index
        row, middle = 2 * self.n_y + 1, 2 * self.n_x
        x_minus, y_minus = i_x[:, None] - i_x, i_y[:, None] - i_y
        sign = np.where(y_minus < 0, -1, 1)
        minus = (sign * x_minus + middle) * row + np.abs(y_minus)
        plus = (i_x[:, None] + i_x + middle) * row + i_y[:, None] + i_y
        return minus, sign.astype(np.float64), plus

    @property
    def series_shape(self) -> tuple[int, int]:
        """Of an array over indices -2 n_x .. 2 n_x, 0 .. 2 n_y: products of two waves are waves of these."""
        return 4 * self.n_x + 1, 2 * self.n_y + 1

    def series_of(self, amplitudes: Complex, fineness: int) -> Complex:
        """Amplitudes of the waves in an array over indices up to `fineness` times n_x, n_y."""
        i_x, i_y = self.index
        n_x, n_y = fineness * self.n_x, fineness * self.n_y
        series = np.zeros((*amplitudes.shape[:-1], 2 * n_x + 1, n_y + 1), np.complex128)
        series[..., i_x + n_x, i_y] = amplitudes
        return series


@dataclass(frozen=True)
class WavesAt:
    """The waves at n points; each is a product of a wave in x and one in y."""

    waves: Waves
    angle_x: Column
    """Phase of the slowest wave along x, shape (n,)."""
    angle_y: Column
    finest: int

    @cached_property
    def _along_x(self) -> Matrix:
        """Cosine and sine, in turn, for indices 0 .. `finest` n_x, shape (2 (finest n_x + 1), n)."""
        return _harmonics(self.angle_x, self.finest * self.waves.n_x)

    @cached_property
    def _along_y(self) -> Matrix:
        """The same for indices 0 .. `finest` n_y."""
        return _harmonics(self.angle_y, self.finest * self.waves.n_y)

    def vectors(self, weights: Matrix) -> Complex:
        """Sums of weights * exp(i k x) over the points: weights of shape (m, n), sums of shape (m, n_waves)."""
        return self._sums(weights, 1)[:, self.waves.single]

    def sums_of_pairs(self, weights: Matrix) -> Complex:
        """Sums of weights * exp(i (k +- k') x) over the points, flat as `Waves.pairs` counts, one row a row.

        Products of waves are waves of sum and difference, so that all entries of a normal matrix come from these.
        """
        return self._sums(weights, 2)

    def evaluate(self, folded: Matrix, fineness: int) -> Matrix:
        """Real parts of the sums of amplitude * exp(i k x), shape (m, n), for the m series that `fold` was given."""
        along_x, along_y = self._up_to(fineness)
        return _contracted(folded @ along_x, along_y)

    def evaluate_on_grid(self, folded: Matrix, fineness: int) -> Matrix:
        """As `evaluate`, at all crossings of these columns (x) and rows (y): shape (m, n_rows, n_columns)."""
        along_x, along_y = self._up_to(fineness)
        rows = (folded @ along_x).reshape(-1, len(along_y), along_x.shape[1])
        return np.asarray(along_y.T @ rows)

    def _up_to(self, fineness: int) -> tuple[Matrix, Matrix]:
        """Cosines and sines for indices up to `fineness` times n_x and n_y, in rows."""
        return self._along_x[: 2 * (fineness * self.waves.n_x + 1)], self._along_y[
            : 2 * (fineness * self.waves.n_y + 1)
        ]

    def _sums(self, weights: Matrix, fineness: int) -> Complex:
        """Over indices -n_x .. n_x, 0 .. n_y times `fineness`; from real products, half as many as complex ones."""
        along_x, along_y = self._up_to(fineness)
        weighted = (weights[:, None, :] * along_x).reshape(len(weights) * len(along_x), -1)
        return _unfolded((weighted @ along_y.T).reshape(len(weights), len(along_x), len(along_y)))


@numba.njit(cache=True)
def fold(series: Complex) -> Matrix:  # pragma: no cover - compiled
    """Amplitudes over indices -n_x .. n_x, 0 .. n_y, shape (m, 2 n_x + 1, n_y + 1), as `WavesAt.evaluate` wants them.

    These are the factors of products of cosines and sines along x and y, shape (m * 2 (n_y + 1), 2 (n_x + 1)).
    """
    n_series, n_x, n_y = len(series), series.shape[1] // 2, series.shape[2] - 1
    folded = np.empty((n_series, n_y + 1, 2, n_x + 1, 2))  # index along y, its cosine or sine, the same along x
    for m in range(n_series):
        for x in range(n_x + 1):
            for y in range(n_y + 1):
                right = series[m, n_x + x, y]
                left = series[m, n_x - x, y] if x else 0j
                folded[m, y, 0, x, 0], folded[m, y, 0, x, 1] = right.real + left.real, left.imag - right.imag
                folded[m, y, 1, x, 0], folded[m, y, 1, x, 1] = -right.imag - left.imag, left.real - right.real
    return folded.reshape(2 * n_series * (n_y + 1), 2 * (n_x + 1))


@numba.njit(cache=True)
def _unfolded(products: Matrix) -> Complex:  # pragma: no cover - compiled
    """Sums over indices -n_x .. n_x, 0 .. n_y, flat, from those of products of cosines and sines along x and y."""
    n_sums, n_x, n_y = len(products), products.shape[1] // 2 - 1, products.shape[2] // 2 - 1
    sums = np.empty((n_sums, 2 * n_x + 1, n_y + 1), np.complex128)
    for m in range(n_sums):
        for x in range(n_x + 1):
            for y in range(n_y + 1):
                cos_cos, cos_sin = products[m, 2 * x, 2 * y], products[m, 2 * x, 2 * y + 1]
                sin_cos, sin_sin = products[m, 2 * x + 1, 2 * y], products[m, 2 * x + 1, 2 * y + 1]
                sums[m, n_x - x, y] = complex(cos_cos + sin_sin, cos_sin - sin_cos)
                sums[m, n_x + x, y] = complex(cos_cos - sin_sin, sin_cos + cos_sin)
    return sums.reshape(n_sums, -1)


@numba.njit(cache=True)
def _contracted(rows: Matrix, along_y: Matrix) -> Matrix:  # pragma: no cover - compiled
    """Sums over the rows of `along_y` times as many rows each, shape (m, n)."""
    n_y, n = along_y.shape
    total = np.zeros((len(rows) // n_y, n))
    for m in range(len(total)):
        for k in range(n_y):
            for point in range(n):
                total[m, point] += rows[m * n_y + k, point] * along_y[k, point]
    return total


@numba.njit(cache=True)
def _evaluated(
    folded: Matrix, angle_x: Column, angle_y: Column, n_x: int, n_y: int
) -> Matrix:  # pragma: no cover - compiled
    """`WavesAt.evaluate` in one call: ways along the flow take a hundred a frame."""
    return _contracted(np.dot(folded, _harmonics(angle_x, n_x)), _harmonics(angle_y, n_y))


@numba.njit(cache=True)
def _harmonics(angle: Column, greatest: int) -> Matrix:  # pragma: no cover - compiled
    """Cosine and sine, in turn, of 0 .. greatest times each angle, shape (2 (greatest + 1), n)."""
    n = len(angle)
    both = np.empty((2 * (greatest + 1), n))
    both[0], both[1] = 1.0, 0.0
    for point in range(n):
        both[2, point], both[3, point] = np.cos(angle[point]), np.sin(angle[point])
    for k in range(2, greatest + 1):
        for point in range(n):
            cosine, sine, c, s = both[2, point], both[3, point], both[2 * k - 2, point], both[2 * k - 1, point]
            both[2 * k, point] = c * cosine - s * sine
            both[2 * k + 1, point] = s * cosine + c * sine
    return both
