"""The Eulerian grid: equal cells over the frame, values at their centres (section 3.2.2)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Grid:
    """`n_rows` x `n_columns` equal cells over a frame of `height_px` x `width_px` pixels."""

    height_px: int
    width_px: int
    n_rows: int
    n_columns: int

    @property
    def x_px(self) -> Column:
        """Centres of the columns, shape (n_columns,). The frame reaches from -0.5 to width - 0.5."""
        return np.asarray((np.arange(self.n_columns) + 0.5) * (self.width_px / self.n_columns) - 0.5, np.float64)

    @property
    def y_px(self) -> Column:
        """Centres of the rows, shape (n_rows,)."""
        return np.asarray((np.arange(self.n_rows) + 0.5) * (self.height_px / self.n_rows) - 0.5, np.float64)

    def cell_of(self, x_px: Column, y_px: Column) -> npt.NDArray[np.int64]:
        """Flat index (row * n_columns + column) of the cell around each point; points outside go to the nearest."""
        row, column = self.position_of(x_px, y_px)
        rows = np.clip(np.rint(row), 0, self.n_rows - 1).astype(np.int64)
        columns = np.clip(np.rint(column), 0, self.n_columns - 1).astype(np.int64)
        return rows * self.n_columns + columns

    def position_of(self, x_px: Column, y_px: Column) -> tuple[Column, Column]:
        """Row and column as real numbers, whole at the centres of cells."""
        row = (y_px + 0.5) * (self.n_rows / self.height_px) - 0.5
        column = (x_px + 0.5) * (self.n_columns / self.width_px) - 0.5
        return row, column

    def contains(self, x_px: Column, y_px: Column) -> npt.NDArray[np.bool_]:
        """Whether each point lies inside the frame."""
        inside_x = (x_px >= -0.5) & (x_px <= self.width_px - 0.5)
        inside_y = (y_px >= -0.5) & (y_px <= self.height_px - 0.5)
        return np.asarray(inside_x & inside_y)

    def spacing_px(self, n_droplets: int) -> float:
        """Mean spacing of `n_droplets` in the frame, px: the edge of the square that each has to itself."""
        return float(np.sqrt(self.height_px * self.width_px / max(n_droplets, 1)))


class CornerGrid(Grid):
    """Points over a frame, the outermost at its edges, instead of cells."""

    @property
    def x_px(self) -> Column:
        """Of the columns, shape (n_columns,)."""
        return np.linspace(-0.5, self.width_px - 0.5, self.n_columns)

    @property
    def y_px(self) -> Column:
        """Of the rows, shape (n_rows,)."""
        return np.linspace(-0.5, self.height_px - 0.5, self.n_rows)

    def position_of(self, x_px: Column, y_px: Column) -> tuple[Column, Column]:
        """Row and column as real numbers, whole at the points."""
        row = (y_px + 0.5) * ((self.n_rows - 1) / self.height_px)
        column = (x_px + 0.5) * ((self.n_columns - 1) / self.width_px)
        return row, column
