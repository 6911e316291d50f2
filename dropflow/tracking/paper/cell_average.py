"""The paper's flow field: averages over cells and their neighbours, smoothed (sections 3.2.2 and 3.2.3)."""

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from dropflow.parameters import PaperFlow
from dropflow.tracking.flow import FlowField, unknown_flow
from dropflow.tracking.grid import Column, Grid

Cells = npt.NDArray[np.float64]
"""Values per cell, shape (..., n_rows, n_columns)."""


def cell_average(grid: Grid, x_px: Column, y_px: Column, advection_um_s: Column, parameters: PaperFlow) -> FlowField:
    """Flow field from the advection of single droplets.

    Each cell is the mean of its N droplets and, with half weight, of the M droplets of the four cells beside it
    (eq. 6). Cells without any are interpolated: they solve Laplace's equation between the computed ones, with no
    slope at the border of the frame. Then the grid is smoothed with 1/4, 1/8 and 1/16 (eq. 7); at the border, where
    neighbours are missing, the weights are scaled to sum to one.

    Parameters
    ----------
    grid : Grid
    x_px, y_px : ndarray, float64, shape (n,)
        Where the droplets were, px.
    advection_um_s : ndarray, float64, shape (2, n)
        Velocity of each droplet minus its sedimentation, um/s.
    parameters : PaperFlow

    Returns
    -------
    FlowField
        Its error is the scatter of the droplets around their cells' means over the root of the effective number in
        each cell; smoothing is taken to leave it as it is, which is an upper bound. Interpolated cells have the
        spread of the computed ones as error.
    """
    if not len(x_px):
        return unknown_flow(grid)
    cell = grid.cell_of(x_px, y_px)
    count = _per_cell(grid, cell, np.ones(len(cell)))
    sums = np.stack([_per_cell(grid, cell, component) for component in advection_um_s])
    share = parameters.neighbour_weight
    weight = count + share * _beside(count)
    computed = weight > 0
    safe_weight = np.where(computed, weight, 1.0)
    mean = (sums + share * _beside(sums)) / safe_weight
    scatter = _scatter(advection_um_s, mean.reshape(2, -1)[:, cell], weight.ravel()[cell])
    std = scatter[:, None, None] * np.sqrt(count + share**2 * _beside(count)) / safe_weight
    spread = np.hypot(mean[:, computed].std(axis=1), scatter)
    std = np.where(computed, std, spread[:, None, None])
    velocity = fill(mean, computed)
    for _ in range(parameters.n_smoothings):
        velocity, std = smooth(velocity), smooth(std)
    return FlowField(grid, velocity, std, count.astype(np.int64), ~computed)


def smooth(values: Cells) -> Cells:
    """Weights 1/4 for a cell, 1/8 beside it, 1/16 diagonal (eq. 7), scaled to sum to one at the border.

    The weights are the product of (1/4, 1/2, 1/4) along either axis, and so is their sum at the border.
    """
    along_x = _smooth_last_axis(values)
    return _smooth_last_axis(along_x.swapaxes(-1, -2)).swapaxes(-1, -2)


def fill(values: Cells, computed: npt.NDArray[np.bool_]) -> Cells:
    """Replace the values of cells that are not `computed` by the solution of Laplace's equation between the others."""
    unknown = np.flatnonzero(~computed)
    if not len(unknown) or not computed.any():
        return values
    n_rows, n_columns = computed.shape
    number = np.full(computed.size, -1)
    number[unknown] = np.arange(len(unknown))
    row, column = np.divmod(unknown, n_columns)
    flat = values.reshape(len(values), -1)
    diagonal, known_part = np.zeros(len(unknown)), np.zeros((len(unknown), len(values)))
    places: list[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]] = []
    for down, right in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        inside = (row + down >= 0) & (row + down < n_rows) & (column + right >= 0) & (column + right < n_columns)
        here = np.flatnonzero(inside)
        neighbour = unknown[here] + down * n_columns + right
        diagonal[here] += 1
        is_known = number[neighbour] < 0
        known_part[here[is_known]] += flat[:, neighbour[is_known]].T
        places.append((here[~is_known], number[neighbour[~is_known]]))
    rows = np.concatenate([np.arange(len(unknown)), *(place[0] for place in places)])
    columns = np.concatenate([np.arange(len(unknown)), *(place[1] for place in places)])
    entries = np.concatenate([diagonal, np.full(len(rows) - len(unknown), -1.0)])
    laplacian = csr_array((entries, (rows, columns)), shape=(len(unknown), len(unknown))).tocsc()
    filled = flat.copy()
    filled[:, unknown] = spsolve(laplacian, known_part).reshape(len(unknown), len(values)).T
    return filled.reshape(values.shape)


def _per_cell(grid: Grid, cell: npt.NDArray[np.int64], weights: Column) -> Cells:
    n_cells = grid.n_rows * grid.n_columns
    total = np.bincount(cell, weights, minlength=n_cells).astype(np.float64)
    return total.reshape(grid.n_rows, grid.n_columns)


def _beside(values: Cells) -> Cells:
    """Sum of the four cells beside each cell."""
    total = np.zeros_like(values)
    total[..., 1:, :] += values[..., :-1, :]
    total[..., :-1, :] += values[..., 1:, :]
    total[..., :, 1:] += values[..., :, :-1]
    total[..., :, :-1] += values[..., :, 1:]
    return total


def _smooth_last_axis(values: Cells) -> Cells:
    total = 2.0 * values
    total[..., 1:] += values[..., :-1]
    total[..., :-1] += values[..., 1:]
    weight = np.full(values.shape[-1], 4.0)
    weight[[0, -1]] = 3.0
    return np.asarray(total / weight)


def _scatter(advection_um_s: Column, mean_of_cell: Column, weight_of_cell: Column) -> Column:
    """Standard deviation of single droplets around the true mean of their cell, shape (2,).

    A residual against a mean that the droplet is part of is too small by its share in it. Where every droplet is
    alone nothing is known but the size of the velocities.
    """
    has_company = weight_of_cell > 1
    if not has_company.any():
        return np.asarray(np.sqrt((advection_um_s**2).mean(axis=1)))
    residual = (advection_um_s - mean_of_cell)[:, has_company]
    return np.asarray(np.sqrt((residual**2 / (1 - 1 / weight_of_cell[has_company])).mean(axis=1)))
