"""The flow of one step from the velocities of droplets: Gaussian-process regression in a basis of waves.

The flow is a Gaussian random field with a given spectrum (`dropflow.tracking.probable.spectrum`); droplets measure it
where they are, each with its own error. In a basis of m waves the most probable flow and its error cost m^3 + n m for
n droplets instead of n^3, for all sums over droplets come from Fourier sums on the lattice of waves.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_triangular

from dropflow.tracking.flow import bilinear
from dropflow.tracking.grid import Column, CornerGrid, Grid
from dropflow.tracking.probable.directions import Up, unturned
from dropflow.tracking.probable.least_squares import Model, Observations, normal_equations, weights
from dropflow.tracking.probable.spectrum import N_COMMON
from dropflow.tracking.probable.waves import Matrix, Waves

_NODES_PER_LENGTH = 2.5


@dataclass(frozen=True)
class WaveFlow:
    """The most probable flow, and how sure it is."""

    model: Model
    amplitudes: Column
    """Of each unknown, in the order of `Model.prior`."""
    factor: Matrix
    """Lower Cholesky factor of I + sqrt(prior) A sqrt(prior), A the normal matrix of the observations."""
    nodes: CornerGrid
    """Between which the error is interpolated."""

    @property
    def stokes_error(self) -> tuple[float, float]:
        """Relative error of Stokes' velocity that these droplets show, and its variance."""
        unit = np.zeros(len(self.amplitudes))
        unit[2] = np.sqrt(self.model.prior[2])
        root = solve_triangular(self.factor, unit, lower=True)
        return float(self.amplitudes[2]) + self.model.factor_mean, float(root @ root)

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

    @cached_property
    def at_nodes(self) -> Column:
        """Velocity along x and y at the nodes, shape (2, n_nodes), um/s."""
        return self.at(*_places(self.nodes))

    @cached_property
    def node_variance(self) -> npt.NDArray[np.float64]:
        """Variance of the error across `up` and along it at the nodes, shape (2, n_rows, n_columns), (um/s)^2."""
        design = _design_at_nodes(self.model.waves, self.nodes, self.model.up, self.model.with_potential)
        return self._variance(design).reshape(2, self.nodes.n_rows, self.nodes.n_columns)

    def variance_at(self, x_px: Column, y_px: Column) -> Column:
        """Variance of the error across `up` and along it at points, shape (2, n), interpolated between nodes."""
        return bilinear(self.nodes, self.node_variance, x_px, y_px)

    def exact_variance_at(self, x_px: Column, y_px: Column) -> Column:
        """The same without interpolation, at the cost of m^2 a point."""
        model = self.model
        return self._variance(_design(model.waves, x_px, y_px, model.up, model.with_potential))

    def _variance(self, design: Matrix) -> Column:
        """Of the error across `up` and along it, shape (2, n), from the design matrix of the points."""
        roots = solve_triangular(self.factor, np.sqrt(self.model.prior)[:, None] * design, lower=True)
        return np.asarray((roots**2).sum(axis=0).reshape(2, -1))


def regress(observations: Observations, model: Model, grid: Grid) -> WaveFlow:
    """The flow that is most probable after the observations, over a frame with this grid."""
    points = model.waves.at(observations.x_px, observations.y_px)
    matrix, vector = normal_equations(observations, points, model, weights(observations, model.spectrum.noise_um_s))
    factor, whitened = solve(matrix, vector, model.prior)
    amplitudes = np.sqrt(model.prior) * solve_triangular(factor.T, whitened, lower=False)
    return WaveFlow(model, np.asarray(amplitudes), factor, nodes_over(grid, model.spectrum.length_px))


def solve(matrix: Matrix, vector: Column, prior: Column) -> tuple[Matrix, Column]:
    """Cholesky factor of I + sqrt(prior) matrix sqrt(prior), and its inverse times sqrt(prior) vector."""
    root = np.sqrt(prior)
    scaled = matrix * root[:, None] * root
    scaled[np.diag_indices_from(scaled)] += 1
    factor = np.asarray(np.linalg.cholesky(scaled), np.float64)
    return factor, np.asarray(solve_triangular(factor, root * vector, lower=True))


def nodes_over(grid: Grid, length_px: float) -> CornerGrid:
    """Points over the frame, as close as the error of the flow varies."""
    sizes = (grid.height_px, grid.width_px)
    n_rows, n_columns = (1 + int(np.clip(np.ceil(_NODES_PER_LENGTH * size / length_px), 4, 24)) for size in sizes)
    return CornerGrid(grid.height_px, grid.width_px, n_rows, n_columns)


def _places(nodes: CornerGrid) -> tuple[Column, Column]:
    x_px, y_px = np.meshgrid(nodes.x_px, nodes.y_px)
    return x_px.ravel(), y_px.ravel()


def _design(waves: Waves, x_px: Column, y_px: Column, up: Up, with_potential: bool) -> Matrix:
    """Velocity across `up`, then along it, at points for each unknown being one, shape (n_unknowns, 2 n)."""
    k_x, k_y = waves.k_per_px
    phase = np.outer(k_x, x_px) + np.outer(k_y, y_px)
    common = np.zeros((N_COMMON, 2, len(x_px)))
    common[0, 0] = common[1, 1] = 1
    kinds = waves.directions(up, with_potential=with_potential)
    turns = (np.cos(phase), np.sin(phase))
    parts = [np.stack([turn * part[:, None] for part in kind], axis=1) for kind in kinds for turn in turns]
    return np.concatenate([common, *parts]).reshape(-1, 2 * len(x_px))


@lru_cache(maxsize=4)
def _design_at_nodes(waves: Waves, nodes: CornerGrid, up: Up, with_potential: bool) -> Matrix:
    return _design(waves, *_places(nodes), up, with_potential)
