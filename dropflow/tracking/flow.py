"""The flow field between two frames, and its value anywhere."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column, Grid


@dataclass(frozen=True)
class FlowField:
    """Velocity of the fluid on a grid, for the step from one frame to the next (sections 3.2.2 and 3.2.3).

    Without a single droplet there is no flow: velocity and its error are NaN everywhere and every cell counts as
    interpolated. With one droplet or more there is no NaN.
    """

    grid: Grid
    velocity_um_s: npt.NDArray[np.float64]
    """Shape (2, n_rows, n_columns), u along x and v along y."""
    velocity_std_um_s: npt.NDArray[np.float64]
    """Standard deviation of the error of each value, same shape."""
    droplet_count: npt.NDArray[np.int64]
    """Droplets inside each cell, shape (n_rows, n_columns)."""
    is_interpolated: npt.NDArray[np.bool_]
    """True where no droplet took part in the cell's value; same shape."""

    @property
    def is_known(self) -> bool:
        """Whether a droplet took part anywhere."""
        return not bool(self.is_interpolated.all())

    def sample(self, x_px: Column, y_px: Column) -> Column:
        """Velocity at points, shape (2, n), um/s: bilinear between centres, constant beyond the outermost ones."""
        return bilinear(self.grid, self.velocity_um_s, x_px, y_px)

    def sample_std(self, x_px: Column, y_px: Column) -> Column:
        """Standard deviation of the velocity's error at points, shape (2, n), um/s."""
        return bilinear(self.grid, self.velocity_std_um_s, x_px, y_px)

    def mean_um_s(self) -> Column:
        """Mean velocity, shape (2,), over the cells that were computed from droplets; zero if there are none."""
        computed = ~self.is_interpolated
        return self.velocity_um_s[:, computed].mean(axis=1) if computed.any() else np.zeros(2)


def unknown_flow(grid: Grid) -> FlowField:
    """The flow field of a step in which no droplet was followed."""
    shape = (grid.n_rows, grid.n_columns)
    nowhere = np.full((2, *shape), np.nan)
    return FlowField(grid, nowhere, nowhere.copy(), np.zeros(shape, np.int64), np.ones(shape, bool))


def still_flow(grid: Grid) -> FlowField:
    """No motion anywhere: the guess when nothing is known."""
    flow = unknown_flow(grid)
    return replace(flow, velocity_um_s=np.zeros_like(flow.velocity_um_s))


def bilinear(
    grid: Grid,
    values: npt.NDArray[np.float64],
    x_px: Column,
    y_px: Column,
    *,
    step: npt.NDArray[np.int64] | None = None,
) -> Column:
    """Values (k, n_rows, n_columns) of the cells' centres at points, shape (k, n); constant beyond the outermost.

    Where the `step` of each point is given, `values` are those of all steps, shape (k, n_steps, n_rows, n_columns).
    """
    row, column = grid.position_of(x_px, y_px)
    row = np.clip(row, 0, grid.n_rows - 1)
    column = np.clip(column, 0, grid.n_columns - 1)
    top = np.minimum(row.astype(np.int64), grid.n_rows - 2)
    left = np.minimum(column.astype(np.int64), grid.n_columns - 2)
    down, right = row - top, column - left
    of_point = (slice(None),) if step is None else (slice(None), step)
    upper = values[*of_point, top, left] * (1 - right) + values[*of_point, top, left + 1] * right
    lower = values[*of_point, top + 1, left] * (1 - right) + values[*of_point, top + 1, left + 1] * right
    return np.asarray(upper * (1 - down) + lower * down)
