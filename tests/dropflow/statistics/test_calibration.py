"""Density difference over viscosity from velocities: its standard error, and radii that are not known equally well."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest

from dropflow.statistics.calibration import Calibration, self_calibration
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories

FIELD_UM = (800.0, 800.0)
N_FRAMES, N_TRAJECTORIES, N_EACH = 120, 300, 10
EXPECTED_S_M2 = -2.5e4
SLOPE_PER_UM_S = 2 * 9.80665 * 2.5e4 * 1e-6 / 9
"""Of the velocity along up over r^2, by eq. (4)."""


def rows(rng: np.random.Generator) -> pl.DataFrame:
    """Droplets that rise by Stokes' law in a smooth flow that changes slowly: neighbours are in nearly the same."""
    start = rng.integers(0, N_FRAMES - N_EACH, N_TRAJECTORIES)
    frame = (start[:, None] + np.arange(N_EACH)).ravel()
    x, y = (np.repeat(rng.uniform(0, 800, N_TRAJECTORIES), N_EACH) for _ in range(2))
    r = np.repeat(np.exp(rng.normal(np.log(12), 0.4, N_TRAJECTORIES)), N_EACH)
    up = SLOPE_PER_UM_S * r**2 + flow(rng, x, y, frame)
    one = np.ones(len(frame))
    return pl.DataFrame(
        {
            "trajectory_id": np.repeat(np.arange(N_TRAJECTORIES), N_EACH),
            "frame": frame,
            "time_s": frame * 1.0,
            "x_um": x,
            "y_um": y,
            "r_um": r,
            "r_px": r / 0.5,
            "r_std_px": 0.02 * r / 0.5,
            "u_um_s": 0 * one,
            "v_um_s": -up,
            "sedimentation_um_s": one,
        }
    )


def flow(
    rng: np.random.Generator, x: npt.NDArray[np.float64], y: npt.NDArray[np.float64], frame: npt.NDArray[np.int64]
) -> npt.NDArray[np.float64]:
    """Waves of 200 to 600 um and 40 to 100 s, rms 7 um/s."""
    total = np.zeros(len(x))
    for _ in range(8):
        kx, ky = rng.normal(0, 1, 2) * 2 * np.pi / rng.uniform(200, 600)
        phase = kx * x + ky * y + 2 * np.pi * (frame / rng.uniform(40, 100) + rng.uniform())
        total += 3.5 * np.cos(phase)
    return total


def calibrated(table: pl.DataFrame, folder: Path) -> Calibration:
    path = folder / "trajectories.parquet"
    table.write_parquet(path)
    return self_calibration(
        path,
        summarise_trajectories(open_trajectories(path)),
        (0.0, -1.0),
        field_um=FIELD_UM,
        density_over_viscosity_s_m2=np.full(N_FRAMES, EXPECTED_S_M2),
    )


def test_the_standard_error_is_the_scatter_of_the_value_between_films(tmp_path: Path) -> None:
    """Over 60 films the deviations over their errors have an rms of 1, known to 9 %."""
    deviations = [calibrated(rows(np.random.default_rng(seed)), tmp_path).deviation for seed in range(60)]
    assert 0.65 < np.sqrt(np.mean(np.square(deviations))) < 1.35
    assert abs(np.mean(deviations)) < 4 / np.sqrt(len(deviations))


def test_radii_that_are_known_badly_count_little(tmp_path: Path) -> None:
    """Half of each trajectory is out of focus, looks 10 % too small, and says that it is uncertain."""
    table = rows(np.random.default_rng(1))
    is_blurred = pl.col("frame") % 2 == 0
    shrunk = table.with_columns(
        r_um=pl.when(is_blurred).then(pl.col("r_um") * 0.9).otherwise(pl.col("r_um")),
        r_std_px=pl.when(is_blurred).then(0.1 * pl.col("r_px")).otherwise(0.01 * pl.col("r_px")),
    )
    sharp, found = calibrated(table, tmp_path), calibrated(shrunk, tmp_path)
    # Taken alike, radii 5 % too small on average would make it 10 % too strong.
    assert abs(found.density_over_viscosity_s_m2 / sharp.density_over_viscosity_s_m2 - 1) < 0.02


def test_radii_without_an_error_count_alike(tmp_path: Path) -> None:
    table = rows(np.random.default_rng(2))
    unknown = calibrated(table.with_columns(r_std_px=pl.lit(float("nan"))), tmp_path)
    known = calibrated(table, tmp_path)
    assert unknown.density_over_viscosity_s_m2 == pytest.approx(known.density_over_viscosity_s_m2)
