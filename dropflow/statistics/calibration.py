"""Density difference over viscosity from the droplets' own velocities: a check of pixel size and material."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl
import pyarrow.parquet as pq

from dropflow.physics.stokes import GRAVITY_M_S2

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

N_COLUMNS, N_ROWS = 8, 8
N_SIGMA_WARNING = 3.0
_LEAST_DEVIATION = 0.05
_LEAST_TRAJECTORIES = 10
"""The scatter between fewer says little of the standard error."""
_M_PER_UM = 1e-6
_ROWS_AT_ONCE = 1 << 18


@dataclass(frozen=True)
class Calibration:
    """What velocity against r^2 says about the fluids."""

    density_over_viscosity_s_m2: float
    """Density difference over viscosity, mean over the film, s/m2, negative for droplets that rise; NaN if it cannot
    be told."""
    std_s_m2: float
    """Its standard error: droplets that follow each other in the same place may err together."""
    n_rows: int
    """Droplets that took part: those that share a frame and a cell with another."""
    n_trajectories: int
    expected_s_m2: float
    """The material's own value, mean over the frames."""
    r2_um2: Floats
    """Mean deviation of r^2 from that of its neighbours, in bins of it, shape (n_bins,): what a figure shows."""
    along_um_s: Floats
    """Mean deviation of the velocity along up from that of the neighbours, in the same bins."""
    along_std_um_s: Floats
    """Standard error of it."""

    @property
    def deviation(self) -> float:
        """Distance from the material's value in standard errors."""
        return (self.density_over_viscosity_s_m2 - self.expected_s_m2) / self.std_s_m2

    def warning(self) -> str | None:
        """What to tell people when the material's value is more than three standard errors and 5 % away."""
        off = self.deviation
        if self.n_trajectories < _LEAST_TRAJECTORIES or not np.isfinite(off) or abs(off) <= N_SIGMA_WARNING:
            return None
        share = self.density_over_viscosity_s_m2 / self.expected_s_m2 if self.expected_s_m2 else np.inf
        if abs(share - 1) < _LEAST_DEVIATION:
            return None
        return (
            f"The droplets' velocities give a density difference over viscosity that is {share:.2f} times that of the "
            f"material ({abs(off):.0f} standard errors away): check pixel size, frame interval, `up` and material."
        )

    def slope_per_um_s(self, density_over_viscosity_s_m2: float) -> float:
        """Slope of the velocity along up (um/s) against r^2 (um2) that belongs to a value."""
        return -density_over_viscosity_s_m2 / _PER_SLOPE


_PER_SLOPE = 4.5 / GRAVITY_M_S2 / _M_PER_UM
"""From a slope in um/s over um^2 to s/m2, by eq. (4)."""


def self_calibration(
    path: Path,
    trajectories: pl.DataFrame,
    up: tuple[float, float],
    *,
    field_um: tuple[float, float],
    density_over_viscosity_s_m2: Floats,
) -> Calibration:
    """Fit the velocity along up against r^2 among droplets that share a frame and a cell.

    Such neighbours are in nearly the same flow, so the difference of their velocities is Stokes' alone. The flow field
    itself must not be subtracted: it was computed with the very material that is to be checked, and a fit to what it
    leaves would give that material back. Radii are means over the trajectory, for noise in r flattens the slope, and
    each counts by the uncertainty that detection gave it: a droplet out of focus looks smaller than it is.

    Parameters
    ----------
    path
        ``trajectories.parquet``, sorted by trajectory; read three times, in batches.
    trajectories
        One row a trajectory, sorted by id (`summarise_trajectories`).
    up
        Direction against gravity.
    field_um
        Width and height of the frame; it is divided into 8 x 8 cells.
    density_over_viscosity_s_m2
        The material's own value in each frame, shape (n_frames,): along a temperature ramp it changes, and r^2 is
        weighed by its share of the mean, so that one factor is fitted for the film.

    Notes
    -----
    The slope k of v = k r^2 gives the density difference over the viscosity as -9 k / (2 g) (eq. 4). The standard
    error is that of a regression with clusters: all rows of a trajectory may err together, and all rows of a cell over
    three mean trajectories, for neighbours share what their flow differs by. The larger of both is taken.
    """
    mean = float(density_over_viscosity_s_m2.mean())
    share = density_over_viscosity_s_m2 / mean if mean else np.ones_like(density_over_viscosity_s_m2)
    pairs = _Pairs(path, trajectories, up, field_um, share)
    found = pairs.fit()
    return Calibration(
        float(-found.slope * _PER_SLOPE),
        float(found.slope_std * _PER_SLOPE),
        found.n_rows,
        found.n_trajectories,
        mean,
        found.x,
        found.y,
        found.y_std,
    )


@dataclass(frozen=True)
class _Line:
    slope: float
    slope_std: float
    n_rows: int
    n_trajectories: int
    x: Floats
    y: Floats
    y_std: Floats


_N_BINS = 16


_TRAJECTORIES_A_BLOCK = 3
"""Length in time of what may err together, in mean trajectories."""
_LEAST_RADIUS_STD = 0.01
"""Of the radius: no single row of a trajectory is to be worth much more than the others."""


class _Pairs:
    """Walks through the rows: radii first, then means of each frame and cell, then what each droplet differs by."""

    def __init__(
        self,
        path: Path,
        trajectories: pl.DataFrame,
        up: tuple[float, float],
        field_um: tuple[float, float],
        share: Floats,
    ) -> None:
        self._path, self._up, self._field_um, self._share = path, up, field_um, share
        self._ids = trajectories["trajectory_id"].to_numpy()
        self._r2_um2 = _radius_um(path, self._ids) ** 2
        mean_frames = float(trajectories["n_frames"].mean() or 1.0)  # type: ignore[arg-type]
        self._block_frames = max(1, round(_TRAJECTORIES_A_BLOCK * mean_frames))

    def fit(self) -> _Line:
        """Regression through the origin of the deviations."""
        n_cells = len(self._share) * N_COLUMNS * N_ROWS
        n, sum_x, sum_y = np.zeros(n_cells, np.int32), np.zeros(n_cells), np.zeros(n_cells)
        for cell, x, y, _ in self._rows():
            first = int(cell.min(initial=0))
            part = slice(first, int(cell.max(initial=-1)) + 1)
            length = part.stop - first
            n[part] += np.bincount(cell - first, minlength=length).astype(np.int32)
            sum_x[part] += np.bincount(cell - first, x, length)
            sum_y[part] += np.bincount(cell - first, y, length)
        edges = self._edges(n_rows=int(n[n > 1].sum()))
        by_trajectory = _Sums(len(self._ids))
        n_blocks = len(self._share) // self._block_frames + 1
        by_block = _Sums(n_blocks * N_COLUMNS * N_ROWS)
        bins = np.zeros((4, _N_BINS))
        for every_cell, r2, along, every_number in self._rows():
            shared = n[every_cell] > 1
            cell, number = every_cell[shared], every_number[shared]
            x, y = r2[shared] - sum_x[cell] / n[cell], along[shared] - sum_y[cell] / n[cell]
            frame, place = np.divmod(cell, N_COLUMNS * N_ROWS)
            by_trajectory.add(number, x, y)
            by_block.add(frame // self._block_frames * N_COLUMNS * N_ROWS + place, x, y)
            which = np.clip(np.searchsorted(edges, x) - 1, 0, _N_BINS - 1)
            bins += [np.bincount(which, of, _N_BINS) for of in (np.ones_like(x), x, y, y * y)]
        return _line(by_trajectory, by_block, bins, n_rows=int(n[n > 1].sum()))

    def _rows(self) -> Iterator[tuple[Integers, Floats, Floats, Integers]]:
        """Cell, weighed r^2, velocity along up and trajectory of the droplets, a batch at a time."""
        names = ["trajectory_id", "frame", "x_um", "y_um", "u_um_s", "v_um_s"]
        with pq.ParquetFile(self._path) as table:
            for batch in table.iter_batches(_ROWS_AT_ONCE, columns=names):
                ids, frame, x_um, y_um, u, v = (batch[name].to_numpy() for name in names)
                along = u * self._up[0] + v * self._up[1]
                number = np.searchsorted(self._ids, ids)
                known = np.isfinite(along) & (frame >= 0) & (frame < len(self._share))
                column = np.clip(x_um / self._field_um[0] * N_COLUMNS, 0, N_COLUMNS - 1).astype(np.int64)
                row = np.clip(y_um / self._field_um[1] * N_ROWS, 0, N_ROWS - 1).astype(np.int64)
                cell = (frame.astype(np.int64) * N_COLUMNS + column) * N_ROWS + row
                r2 = self._r2_um2[number] * self._share[np.clip(frame, 0, len(self._share) - 1)]
                yield cell[known], r2[known], along[known], number[known].astype(np.int64)

    def _edges(self, n_rows: int) -> Floats:
        """Bins of the deviation of r^2, two standard deviations to either side."""
        reach = 2 * float(self._r2_um2.std()) if n_rows and len(self._r2_um2) else 1.0
        return np.linspace(-reach, reach, _N_BINS + 1)


class _Sums:
    """Sums of x^2 and x y over the rows of each cluster."""

    def __init__(self, n_clusters: int) -> None:
        self.xx, self.xy = np.zeros(n_clusters), np.zeros(n_clusters)

    def add(self, cluster: Integers, x: Floats, y: Floats) -> None:
        self.xx += np.bincount(cluster, x * x, len(self.xx))
        self.xy += np.bincount(cluster, x * y, len(self.xy))

    def n(self) -> int:
        return int(np.count_nonzero(self.xx))

    def slope_std(self, slope: float) -> float:
        """Standard error of a slope if rows of a cluster err together, and clusters independently."""
        n = self.n()
        scatter = self.xy - slope * self.xx
        return float(np.sqrt((scatter**2).sum() * n / max(n - 1, 1)) / self.xx.sum())


def _radius_um(path: Path, ids: Integers) -> Floats:
    """Mean radius of each trajectory, shape (len(ids),), rows weighted by the uncertainty that they state."""
    weights, sums = np.zeros(len(ids)), np.zeros(len(ids))
    names = ["trajectory_id", "r_um", "r_px", "r_std_px"]
    with pq.ParquetFile(path) as table:
        for batch in table.iter_batches(_ROWS_AT_ONCE, columns=names):
            row_ids, r_um, r_px, r_std_px = (batch[name].to_numpy() for name in names)
            number = np.searchsorted(ids, row_ids)
            relative = np.nan_to_num(r_std_px / r_px)  # not known of droplets of the first version
            weight = 1 / (r_um**2 * (relative**2 + _LEAST_RADIUS_STD**2))
            weights += np.bincount(number, weight, len(ids))
            sums += np.bincount(number, weight * r_um, len(ids))
    return np.asarray(sums / np.maximum(weights, np.finfo(float).tiny))


def _line(by_trajectory: _Sums, by_block: _Sums, bins: Floats, *, n_rows: int) -> _Line:
    n_trajectories = by_trajectory.n()
    n, x, y, yy = bins
    known = n > 1
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = (y / n)[known]
        # Rows of a trajectory err together: as many are independent as there are trajectories to so many rows.
        n_independent = np.maximum(n[known] * n_trajectories / max(n_rows, 1), 1.0)
        std = np.sqrt(np.maximum((yy / n)[known] - mean**2, 0) / n_independent)
        centre = (x / n)[known]
    if n_trajectories < 3:
        return _Line(np.nan, np.nan, n_rows, n_trajectories, centre, mean, std)
    slope = float(by_trajectory.xy.sum() / by_trajectory.xx.sum())
    slope_std = max(sums.slope_std(slope) for sums in (by_trajectory, by_block))
    return _Line(slope, slope_std, n_rows, n_trajectories, centre, mean, std)
