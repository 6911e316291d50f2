"""Density difference over viscosity from the droplets' own velocities: a check of pixel size and material."""

from dataclasses import dataclass

import numpy as np
import polars as pl

from dropflow.physics.stokes import GRAVITY_M_S2

N_COLUMNS, N_ROWS = 8, 8
N_SIGMA_WARNING = 3.0
_M_PER_UM = 1e-6


@dataclass(frozen=True)
class Calibration:
    """What velocity against r^2 says about the fluids."""

    density_over_viscosity_s_m2: float
    """Density difference over viscosity, s/m2, negative for droplets that rise; NaN if it cannot be told."""
    std_s_m2: float
    """Its standard error, trajectories taken as independent."""
    n_rows: int
    """Droplets that took part: those that share a frame and a cell with another."""
    n_trajectories: int

    def deviation(self, expected_s_m2: float) -> float:
        """Distance from a material's value in standard errors."""
        return (self.density_over_viscosity_s_m2 - expected_s_m2) / self.std_s_m2

    def warning(self, expected_s_m2: float) -> str | None:
        """What to tell people when the material's value is more than three standard errors and 5 % away."""
        off = self.deviation(expected_s_m2)
        if not np.isfinite(off) or abs(off) <= N_SIGMA_WARNING:
            return None
        share = self.density_over_viscosity_s_m2 / expected_s_m2 if expected_s_m2 else np.inf
        if abs(share - 1) < 0.05:
            return None
        return (
            f"The droplets' velocities give a density difference over viscosity that is {share:.2f} times that of the "
            f"material ({abs(off):.0f} standard errors away): check pixel size, frame interval, `up` and material."
        )


def self_calibration(rows: pl.LazyFrame, up: tuple[float, float], *, field_um: tuple[float, float]) -> Calibration:
    """Fit the velocity along up against r^2 among droplets that share a frame and a cell.

    Such neighbours are in nearly the same flow, so the difference of their velocities is Stokes' alone. The flow field
    itself must not be subtracted: it was computed with the very material that is to be checked, and a fit to what it
    leaves would give that material back. Radii are means over the trajectory, for noise in r flattens the slope.

    Parameters
    ----------
    rows
        Rows of `dropflow.tables.TRAJECTORIES`.
    up
        Direction against gravity.
    field_um
        Width and height of the frame; it is divided into 8 x 8 cells.

    Notes
    -----
    The slope k of v = k r^2 gives the density difference over the viscosity as -9 k / (2 g) (eq. 4). The standard
    error is that of a regression with clusters: all rows of a trajectory may err together.
    """
    grouped = _demeaned(rows, up, field_um)
    sums = grouped.group_by("trajectory_id").agg(
        xx=(pl.col("x") ** 2).sum(), xy=(pl.col("x") * pl.col("y")).sum(), n=pl.len()
    )
    found = sums.collect(engine="streaming")
    xx, xy = found["xx"].to_numpy(), found["xy"].to_numpy()
    n_rows = int(found["n"].sum())
    if len(found) < 3 or xx.sum() <= 0:
        return Calibration(np.nan, np.nan, n_rows, len(found))
    slope = xy.sum() / xx.sum()
    scatter = xy - slope * xx
    std = np.sqrt((scatter**2).sum() * len(xx) / (len(xx) - 1)) / xx.sum()
    # um/s over um^2, as 1/(m s).
    per_slope = 4.5 / GRAVITY_M_S2 / _M_PER_UM
    return Calibration(float(-slope * per_slope), float(std * per_slope), n_rows, len(found))


def _demeaned(rows: pl.LazyFrame, up: tuple[float, float], field_um: tuple[float, float]) -> pl.LazyFrame:
    """Radius squared (x) and velocity along up (y) of each droplet minus the means of its frame and cell."""
    column = (pl.col("x_um") / field_um[0] * N_COLUMNS).floor().cast(pl.Int32)
    row = (pl.col("y_um") / field_um[1] * N_ROWS).floor().cast(pl.Int32)
    radius = rows.group_by("trajectory_id").agg(r2=pl.col("r_um").mean().cast(pl.Float32) ** 2)
    droplets = (
        rows.select(
            "trajectory_id",
            cell=pl.col("frame").cast(pl.Int64) * (N_COLUMNS * N_ROWS) + column * N_ROWS + row,
            v=(pl.col("u_um_s") * up[0] + pl.col("v_um_s") * up[1]).cast(pl.Float32),
        )
        .filter(pl.col("v").is_finite())
        .join(radius, on="trajectory_id")
    )
    means = droplets.group_by("cell").agg(mean_r2=pl.col("r2").mean(), mean_v=pl.col("v").mean(), n=pl.len())
    return droplets.join(means.filter(pl.col("n") > 1), on="cell").select(
        "trajectory_id",
        x=(pl.col("r2") - pl.col("mean_r2")).cast(pl.Float64),
        y=(pl.col("v") - pl.col("mean_v")).cast(pl.Float64),
    )


def expected_density_over_viscosity(delta_density_kg_m3: float, viscosity_pa_s: float) -> float:
    """The material's own value, s/m2."""
    return delta_density_kg_m3 / viscosity_pa_s
