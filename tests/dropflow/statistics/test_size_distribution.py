import numpy as np
import pyarrow as pa
import pytest

from dropflow.statistics.histograms import coarsen, frame_histograms, radius_edges_um
from dropflow.statistics.size_distribution import size_distribution, size_moments

EDGES_UM = radius_edges_um(4.0, 40.0, 24)
N_FRAMES, N_DROPLETS = 40, 300
AREA_UM2, DEPTH_UM = 1.0e6, 30.0


@pytest.fixture(scope="module")
def radii_um() -> np.ndarray:
    return np.random.default_rng(3).triangular(5, 12, 38, (N_FRAMES, N_DROPLETS))


@pytest.fixture(scope="module")
def histograms(radii_um: np.ndarray):
    frame = np.repeat(np.arange(N_FRAMES, dtype=np.int32), N_DROPLETS)
    table = pa.table({"frame": frame, "r_um": radii_um.ravel()})
    return frame_histograms(table, EDGES_UM, range(N_FRAMES), np.arange(N_FRAMES) * 1.0)


def test_the_density_integrates_to_the_droplets_per_volume(histograms) -> None:
    found = size_distribution(histograms, area_um2=AREA_UM2, observation_depth_um=DEPTH_UM)
    per_volume = (found.density * np.diff(EDGES_UM)).sum(axis=1)
    np.testing.assert_allclose(per_volume, N_DROPLETS / (AREA_UM2 * DEPTH_UM))
    assert found.unit == "um^-4"


def test_a_depth_that_grows_with_the_radius_divides_each_bin_by_its_own(histograms) -> None:
    flat = size_distribution(histograms, area_um2=AREA_UM2)
    deep = size_distribution(histograms, area_um2=AREA_UM2, observation_depth_um=2.0 * histograms.radius_um)
    np.testing.assert_allclose(deep.density * 2.0 * histograms.radius_um, flat.density)
    assert flat.unit == "um^-3"


def test_the_spread_between_frames_is_the_poisson_uncertainty(histograms) -> None:
    """The counts of a bin in 40 independent frames scatter by what is stated, within 4 sigma of that estimate."""
    found = size_distribution(histograms, area_um2=AREA_UM2)
    busiest = histograms.counts.sum(axis=0).argmax()
    scatter = found.density[:, busiest].std(ddof=1)
    assert scatter / found.density_std[:, busiest].mean() == pytest.approx(1, abs=4 / np.sqrt(2 * N_FRAMES))


def test_moments_are_those_of_the_radii(histograms, radii_um) -> None:
    found = size_moments(histograms, area_um2=AREA_UM2, observation_depth_um=DEPTH_UM)
    np.testing.assert_allclose(found.n_per_frame, N_DROPLETS)
    np.testing.assert_allclose(found.mean_radius_um, radii_um.mean(axis=1))
    np.testing.assert_allclose(found.sauter_radius_um, (radii_um**3).sum(axis=1) / (radii_um**2).sum(axis=1))
    volume = 4 / 3 * np.pi * (radii_um**3).sum(axis=1) / (AREA_UM2 * DEPTH_UM)
    np.testing.assert_allclose(found.fraction, volume, rtol=0.02)
    width = EDGES_UM[1] / EDGES_UM[0]
    np.testing.assert_allclose(np.log(found.percentiles_um[:, 1] / np.median(radii_um, axis=1)), 0, atol=np.log(width))


def test_stated_errors_of_the_means_are_their_scatter_between_frames(histograms) -> None:
    found = size_moments(histograms, area_um2=AREA_UM2)
    for value, std in (
        (found.mean_radius_um, found.mean_radius_std_um),
        (found.sauter_radius_um, found.sauter_radius_std_um),
    ):
        assert value.std(ddof=1) / std.mean() == pytest.approx(1, abs=4 / np.sqrt(2 * N_FRAMES))


def test_summed_frames_give_the_mean_density_with_less_noise(histograms) -> None:
    one = coarsen(histograms, 1)
    many, few = (size_distribution(part, area_um2=AREA_UM2) for part in (histograms, one))
    np.testing.assert_allclose(few.density[0], many.density.mean(axis=0))
    busiest = histograms.counts.sum(axis=0).argmax()
    assert few.density_std[0, busiest] == pytest.approx(
        many.density_std[:, busiest].mean() / np.sqrt(N_FRAMES), rel=0.02
    )


def test_without_droplets_means_do_not_exist_and_numbers_are_zero() -> None:
    table = pa.table({"frame": pa.array([], pa.int32()), "r_um": pa.array([], pa.float64())})
    found = size_moments(frame_histograms(table, EDGES_UM, range(2), np.arange(2.0)), area_um2=1.0)
    assert found.n_per_frame.tolist() == [0, 0]
    assert found.fraction.tolist() == [0, 0]
    assert np.isnan(found.mean_radius_um).all()
    assert np.isnan(found.percentiles_um).all()
