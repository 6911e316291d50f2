"""Radii along trajectories: as good as all frames together where they can be, and no further."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest

from dropflow.tracking.radii import RadiusChanges, RadiusErrors, smoothed_radii

Floats = npt.NDArray[np.float64]
N_FRAMES = 40
STD = 0.04


def rows(true_px: Floats, *, std: float = STD, claimed: float = STD, seed: int = 0, dt_s: float = 1.0) -> pa.Table:
    """Trajectories of these true radii, shape (n, n_frames), measured with this relative error."""
    n, n_frames = true_px.shape
    r_px = true_px * np.exp(np.random.default_rng(seed).normal(0, std, true_px.shape))
    none = np.zeros(n * n_frames)
    columns: dict[str, Any] = {
        "trajectory_id": np.repeat(np.arange(n), n_frames),
        "frame": np.tile(np.arange(n_frames, dtype=np.int32), n),
        "time_s": np.tile(dt_s * np.arange(n_frames), n),
        "r_px": r_px.ravel(),
        "r_std_px": claimed * r_px.ravel(),
        **dict.fromkeys(("x_px", "y_px", "u_um_s", "v_um_s", "sedimentation_um_s"), none),
    }
    return pa.table(columns)


def learnt(table: pa.Table) -> RadiusErrors:
    changes = RadiusChanges()
    changes.add(table)
    return changes.errors()


def off(table: pa.Table, true_px: Floats, errors: RadiusErrors, is_new: npt.NDArray[np.bool_] | None = None) -> Floats:
    """Ln of smoothed over true radius, shape (n, n_frames)."""
    new = np.zeros(len(table), bool) if is_new is None else is_new
    smooth_px, _ = smoothed_radii(table, errors, new)
    return np.log(smooth_px.reshape(true_px.shape) / true_px)


def test_the_film_says_how_large_errors_are_and_how_quickly_radii_change() -> None:
    """Whatever detection claims of them."""
    rng = np.random.default_rng(1)
    walk = 10 * np.exp(np.cumsum(rng.normal(0, 0.01, (400, N_FRAMES)), axis=1))
    found = learnt(rows(walk, claimed=2 * STD))
    assert np.sqrt(found.growth_per_s) == pytest.approx(0.01, rel=0.15)
    assert np.sqrt(found.variance_scale) == pytest.approx(0.5, rel=0.1)


def test_radii_that_stay_are_averaged_over_all_frames() -> None:
    """The error falls nearly as that of a mean, and is what is said of it."""
    true = np.full((200, N_FRAMES), 12.0)
    table = rows(true)
    error = off(table, true, learnt(table)).std()
    assert error < 2 * STD / np.sqrt(N_FRAMES)
    _, std_px = smoothed_radii(table, learnt(table), np.zeros(len(table), bool))
    assert error <= np.median(std_px) / 12.0 < 0.02


def test_waves_of_growth_are_not_smoothed_away() -> None:
    """Radii that go up and down by a fifth within twenty frames stay as they are, with less noise."""
    phase = 2 * np.pi * np.arange(N_FRAMES) / 20
    true = 10 * np.exp(0.1 * np.sin(phase))[None] * np.ones((300, 1))
    table = rows(true)
    error = off(table, true, learnt(table))
    assert np.abs(error.mean(axis=0)).max() < 0.025
    assert np.sqrt((error**2).mean()) < 0.9 * STD


def test_nothing_is_smoothed_across_a_coalescence() -> None:
    """Neither one that was claimed, however small, nor a jump that nobody claimed."""
    true = np.full((100, N_FRAMES), 10.0)
    true[:, 20:] *= 1.05
    table = rows(true, std=0.01, claimed=0.01)
    is_new = (np.arange(table.num_rows) % N_FRAMES) == 20
    errors = RadiusErrors(1e-8, 1.0)
    assert np.abs(off(table, true, errors, is_new).mean(axis=0)).max() < 0.003
    true[:, 20:] *= 1.2
    table = rows(true, std=0.01, claimed=0.01)
    assert np.abs(off(table, true, errors).mean(axis=0)).max() < 0.003


def test_a_single_wrong_radius_is_no_jump() -> None:
    """What was before it and after it belong together."""
    true = np.full((1, 9), 10.0)
    table = rows(true, std=0.0, claimed=0.02)
    r_px = table["r_px"].to_numpy().copy()
    r_px[4] = 13.0
    table = table.set_column(table.column_names.index("r_px"), "r_px", pa.array(r_px))
    smooth_px, _ = smoothed_radii(table, RadiusErrors(1e-8, 1.0), np.zeros(9, bool))
    assert smooth_px.max() < 10.6


@pytest.mark.parametrize("n_rows", [0, 1, 2])
def test_short_tables_are_as_they_are(n_rows: int) -> None:
    """And say nothing of the film."""
    table = rows(np.full((1, 3), 8.0), std=0.0).slice(0, n_rows)
    errors = learnt(table)
    assert errors.variance_scale == 1.0
    smooth_px, std_px = smoothed_radii(table, errors, np.zeros(n_rows, bool))
    np.testing.assert_allclose(smooth_px, 8.0)
    assert np.isfinite(std_px).all()


def test_an_unknown_error_is_taken_as_usual() -> None:
    """Radii without a standard deviation take part."""
    table = rows(np.full((1, 5), 8.0), std=0.0)
    std_px = table["r_std_px"].to_numpy().copy()
    std_px[2] = np.nan
    table = table.set_column(table.column_names.index("r_std_px"), "r_std_px", pa.array(std_px))
    smooth_px, found_px = smoothed_radii(table, RadiusErrors(1e-4, 1.0), np.zeros(5, bool))
    np.testing.assert_allclose(smooth_px, 8.0)
    assert np.isfinite(found_px).all()
