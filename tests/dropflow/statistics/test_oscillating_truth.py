"""What statistics find in a film of nucleation waves, against what was put in; tolerances follow from the counts."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest

from dropflow.simulation.oscillating import WaveFlow, wave_flow
from dropflow.statistics.calibration import Calibration, self_calibration
from dropflow.statistics.flow_bins import bin_flow, edges_of_oscillations
from dropflow.statistics.flow_correlation import flow_correlation
from dropflow.statistics.flow_moments import flow_moments
from dropflow.statistics.growth import growth_by_radius
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.lengths import observed_depth, trajectory_lengths
from dropflow.statistics.oscillations import Signal, find_oscillations
from dropflow.statistics.sedimentation import radius_scatter, velocity_by_radius
from dropflow.statistics.size_distribution import size_distribution
from dropflow.statistics.table_histograms import histograms_of_table
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories
from tests.dropflow.statistics.conftest import RADIUS_STD, SCENARIO, WAVES

UP = (0.0, -1.0)
EDGES_UM = radius_edges_um(4.0, 50.0, 14)
WIDTH_UM = SCENARIO.width_px * SCENARIO.pixel_size_um
HEIGHT_UM = SCENARIO.height_px * SCENARIO.pixel_size_um
N_FRAMES = int(WAVES.duration_s)


@pytest.fixture(scope="module")
def histograms(waves_film: Path) -> FrameHistograms:
    return histograms_of_table(
        waves_film / "trajectories.parquet", radius_edges_um(4.0, 50.0), np.arange(N_FRAMES, dtype=float)
    )


@pytest.fixture(scope="module")
def flow(waves_film: Path) -> WaveFlow:
    return wave_flow(SCENARIO, WAVES, 4)


@pytest.mark.parametrize("signal", [Signal.N_SMALL, Signal.N_DROPLETS])
def test_the_periods_put_in_come_back_within_their_uncertainty(histograms: FrameHistograms, signal: Signal) -> None:
    found = find_oscillations(histograms, signal=signal)
    true_s = np.diff(WAVES.starts_s[1:5])
    assert len(found.period_s) == len(true_s) == 3
    assert found.is_certain.all()
    assert (np.abs(found.period_s - true_s) < 3 * found.period_std_s).all()
    assert (found.period_std_s < 0.2 * true_s).all()


def test_the_distribution_is_that_of_the_visible_droplets(waves_film: Path, histograms: FrameHistograms) -> None:
    """In each bin with 200 droplets and more, with 3 % of noise in r, within 5 standard errors and 10 %."""
    rows = pl.read_parquet(waves_film / "trajectories.parquet", columns=["frame", "trajectory_id"])
    truth = pl.read_parquet(waves_film / "truth.parquet").filter(pl.col("visibility") == "visible")
    true_counts = np.histogram(truth["r_um"].to_numpy(), bins=histograms.edges_um)[0] * len(rows) / len(truth)
    density = size_distribution(histograms, area_um2=WIDTH_UM * HEIGHT_UM)
    widths = np.diff(histograms.edges_um)
    found = (density.density * widths).sum(axis=0) * WIDTH_UM * HEIGHT_UM
    np.testing.assert_allclose(found, histograms.counts.sum(axis=0))
    full = true_counts > 200
    off = np.abs(found[full] - true_counts[full])
    assert (off < 5 * np.sqrt(true_counts[full]) + 0.1 * true_counts[full]).all()


EXPECTED_S_M2 = SCENARIO.delta_density_kg_m3 / SCENARIO.viscosity_pa_s


def calibrate(path: Path, *, scale: float = 1.0, expected_s_m2: npt.ArrayLike = EXPECTED_S_M2) -> Calibration:
    n_frames = int(pl.read_parquet(path, columns=["frame"])["frame"].max()) + 1
    return self_calibration(
        path,
        summarise_trajectories(open_trajectories(path)),
        UP,
        field_um=(scale * WIDTH_UM, scale * HEIGHT_UM),
        density_over_viscosity_s_m2=np.broadcast_to(np.asarray(expected_s_m2, np.float64), (n_frames,)),
    )


def test_density_over_viscosity_comes_back_without_any_material(waves_film: Path) -> None:
    found = calibrate(waves_film / "trajectories.parquet")
    assert abs(found.deviation) < 3.5
    assert found.std_s_m2 < 0.03 * abs(EXPECTED_S_M2)
    assert found.warning() is None
    slope = found.slope_per_um_s(found.density_over_viscosity_s_m2)
    off = np.abs(found.along_um_s - slope * found.r2_um2)
    assert (off < 5 * found.along_std_um_s + 0.05 * np.abs(found.along_um_s)).all()


def test_a_material_that_changes_along_the_ramp_is_weighed_frame_by_frame(waves_film: Path, tmp_path: Path) -> None:
    """Sedimentation made twice as strong in the second half: one factor fits all, and that of the mean comes back."""
    rows = pl.read_parquet(waves_film / "trajectories.parquet")
    n_frames = int(rows["frame"].max()) + 1
    strength = np.where(np.arange(n_frames) < n_frames // 2, 1.0, 2.0)
    more = pl.Series(strength[rows["frame"].to_numpy()] - 1)
    path = tmp_path / "trajectories.parquet"
    rows.with_columns(v_um_s=pl.col("v_um_s") - more * pl.col("sedimentation_um_s")).write_parquet(path)
    found = calibrate(path, expected_s_m2=EXPECTED_S_M2 * strength)
    assert found.expected_s_m2 == pytest.approx(EXPECTED_S_M2 * strength.mean())
    assert abs(found.deviation) < 3.5


def test_a_wrong_pixel_size_is_noticed(waves_film: Path, tmp_path: Path) -> None:
    """With pixels 1.3 times too large, lengths and speeds grow alike, so drho/eta shrinks by that factor."""
    path = tmp_path / "trajectories.parquet"
    rows = pl.read_parquet(waves_film / "trajectories.parquet")
    rows.with_columns([pl.col(name) * 1.3 for name in ("x_um", "y_um", "r_um", "u_um_s", "v_um_s")]).write_parquet(path)
    found = calibrate(path, scale=1.3)
    assert found.density_over_viscosity_s_m2 / EXPECTED_S_M2 == pytest.approx(1 / 1.3, rel=0.1)
    assert "pixel size" in (found.warning() or "")


def test_velocity_against_radius_is_stokes_plus_the_mean_flow(trajectories: pl.DataFrame, waves_film: Path) -> None:
    """The flow is the same for neighbours, so a few times its own scatter over the film is allowed, too."""
    moments = flow_moments(waves_film / "truth_flow.zarr", UP)
    upward = float(np.nanmean(moments.mean_um_s[:, 1]))
    found = velocity_by_radius(trajectories, EDGES_UM, mean_upward_flow_um_s=upward)
    used = found.measured.n >= 20
    off = np.abs(found.measured.mean - found.expected_um_s)[used]
    assert used.sum() >= 8
    assert (off < 4 * np.hypot(found.measured.standard_error[used], 0.7)).all()


def test_the_scatter_of_the_radius_is_the_noise_put_in(trajectories: pl.DataFrame) -> None:
    found = radius_scatter(trajectories, EDGES_UM)
    relative = (found.scatter.mean / found.scatter.x)[found.scatter.n >= 30]
    np.testing.assert_allclose(relative, RADIUS_STD, rtol=0.15)


def test_droplets_grow_as_they_were_made_to(trajectories: pl.DataFrame, waves_film: Path) -> None:
    """Against the slopes of the same droplets without noise, within 4 standard errors."""
    truth = pl.read_parquet(waves_film / "truth.parquet").sort("droplet_id", "frame")
    change = truth.with_columns(
        rate=(pl.col("r_um").shift(-1) - pl.col("r_um")).over("droplet_id"),
    ).filter((pl.col("visibility") == "visible") & pl.col("rate").is_not_null())
    found = growth_by_radius(trajectories, EDGES_UM)
    bins = np.searchsorted(EDGES_UM, change["r_um"].to_numpy(), side="right") - 1
    for number in np.flatnonzero(found.rate.n >= 40):
        true_um_s = change["rate"].to_numpy()[bins == number].mean()
        off = abs(found.rate.mean[number] - true_um_s)
        assert off < 4 * found.rate.standard_error[number] + 0.05 * true_um_s


def test_no_trajectory_outlasts_sedimentation_through_the_frame(trajectories: pl.DataFrame) -> None:
    found = trajectory_lengths(trajectories, EDGES_UM, frame_height_um=HEIGHT_UM)
    assert found.counts.sum() == trajectories.filter(pl.col("r_mean_um").is_between(4.0, 50.0)).height
    large = (found.mean_s.x > 20) & (found.mean_s.n > 5)
    assert (found.mean_s.mean[large] < found.bound_s[large]).all()


def test_small_droplets_are_seen_longer_the_larger_they_are(trajectories: pl.DataFrame) -> None:
    """The simulated depth is 3.0 to 3.5 radii. Waves end some trajectories early, so the estimate is low."""
    found = observed_depth(
        trajectories,
        EDGES_UM,
        frame_size_um=(WIDTH_UM, HEIGHT_UM),
        depth_speed_um_s=float(SCENARIO.flow_depth_rms_um_s * np.sqrt(2 / np.pi)),
        sideways_speed_um_s=float(SCENARIO.flow_rms_um_s * np.sqrt(2 / np.pi)),
    )
    assert 1.5 < found.per_radius < 4.0
    assert found.per_radius_std < 0.3 * found.per_radius


def test_four_bins_an_oscillation_show_the_beat_of_the_flow(waves_film: Path, flow: WaveFlow) -> None:
    moments = flow_moments(waves_film / "truth_flow.zarr", UP)
    edges_s = edges_of_oscillations(WAVES.starts_s[1:5])
    assert len(edges_s) == 13
    binned = bin_flow(moments, edges_s, correlation_time_s=30.0)
    beat = binned.rms_um_s[:, 0].reshape(3, 4).mean(axis=0)
    assert min(beat[1], beat[2]) > 1.5 * max(beat[0], beat[3])
    mean = float(np.average([flow.waves.swing(t, flow.waves.drift_swing) for t in moments.time_s]))
    assert moments.mean_um_s[:, 1].mean() == pytest.approx(-SCENARIO.drift_y_um_s * mean, abs=2.0)


def test_the_flow_correlates_over_about_the_length_and_time_put_in(waves_film: Path) -> None:
    """The vector correlates as (1 - d^2 / (2 L^2)) exp(-d^2 / (2 L^2)), which passes 1/e at about 0.95 L.

    The frame holds few such lengths and the film few such times, and the mean of each step is taken away: 40 %.
    """
    found = flow_correlation(waves_film / "truth_flow.zarr", pixel_size_um=SCENARIO.pixel_size_um)
    assert found.length_um == pytest.approx(0.95 * SCENARIO.flow_length_um, rel=0.4)
    assert found.time_s == pytest.approx(np.sqrt(2) * SCENARIO.flow_time_s, rel=0.4)
    assert found.length_std_um < 0.3 * found.length_um
