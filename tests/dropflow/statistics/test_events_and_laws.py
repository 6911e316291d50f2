"""Coalescence, collision efficiency, periods against driving, and what empty and tiny films give."""

from pathlib import Path

import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from dropflow.errors import ResultsError
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.write import write_experiment
from dropflow.statistics.calibration import self_calibration
from dropflow.statistics.coalescence import coalescence_rates, coalescences
from dropflow.statistics.growth import Growth, collision_efficiency, growth_by_radius, swept_growth_um_s
from dropflow.statistics.histograms import FrameHistograms, radius_edges_um
from dropflow.statistics.lengths import observed_depth, trajectory_lengths
from dropflow.statistics.oscillations import driving_group, find_oscillations, period_law
from dropflow.statistics.sedimentation import radius_scatter, velocity_by_radius
from dropflow.statistics.table_histograms import histograms_of_table
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories
from dropflow.tables import TRAJECTORIES
from dropflow.tracking.events import EVENTS
from tests.dropflow.statistics.truth import Fates, droplets_of_rows, large_coalescences, seen_of_truth
from tests.dropflow.tracking.tracked import tracked

EDGES_UM = radius_edges_um(4.0, 40.0, 10)


def table(rows: list[tuple[int, int, float, float, float]]) -> pl.LazyFrame:
    """Trajectories from (id, frame, x, y, r), at rest unless frames differ, one frame a second."""
    ids, frames, x, y, r = zip(*rows, strict=True)
    return pl.LazyFrame(
        {
            "trajectory_id": ids,
            "frame": frames,
            "time_s": [float(frame) for frame in frames],
            "x_um": x,
            "y_um": y,
            "r_um": r,
            "u_um_s": [0.0] * len(rows),
            "v_um_s": [0.0] * len(rows),
            "sedimentation_um_s": [1.0] * len(rows),
        },
        schema_overrides={"x_um": pl.Float64, "y_um": pl.Float64, "r_um": pl.Float64},
    )


def test_what_tracking_saw_coalesce_is_counted_by_size(tmp_path: Path) -> None:
    nothing = dict.fromkeys(EVENTS.names)
    pair = {"kind": "coalescence", "trajectory_id": 2, "other_id": 1, "product_id": 3, "r_1_um": 12.0, "r_2_um": 10.0}
    rows = [
        {**nothing, **pair, "frame": 5, "time_s": 5.0, "x_px": 160.0, "y_px": 80.0, "r_um": 14.0},
        {**nothing, "kind": "birth", "frame": 6, "trajectory_id": 7},
    ]
    pq.write_table(pa.Table.from_pylist(rows, schema=EVENTS), tmp_path / "events.parquet")
    found = coalescences(tmp_path / "events.parquet", pixel_size_um=0.5)
    (event,) = found.to_dicts()
    assert (event["parent_1"], event["parent_2"], event["product"], event["frame"]) == (2, 1, 3, 5)
    assert (event["x_um"], event["y_um"], event["r_product_um"]) == (80.0, 40.0, 14.0)
    rates = coalescence_rates(found, EDGES_UM, area_um2=4.8e5, duration_s=8.0)
    smaller, larger = np.searchsorted(EDGES_UM, [10.0, 12.0]) - 1
    assert np.argwhere(rates.counts).tolist() == [[smaller, larger]]
    assert rates.rate_per_um2_s.sum() == pytest.approx(1 / (4.8e5 * 8))


def test_results_without_events_are_refused_and_not_taken_for_films_without_coalescence(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="missing") as refused:
        coalescences(tmp_path / "events.parquet", pixel_size_um=0.5)
    assert refused.value.file == str(tmp_path / "events.parquet")
    assert "again" in str(refused.value.hint)


def test_of_coalescences_that_are_found_few_are_made_up_and_large_ones_are_found(tmp_path: Path) -> None:
    """At least 4 of 5 are true, both partners parts of one droplet then: by the identity of droplets, not by place.

    A quarter at least is found of those in sight whose smaller partner brings a fifth of the larger one's volume.
    """
    scenario = Scenario(
        name="coalescing",
        height_px=500,
        width_px=600,
        n_droplets=2000,
        collision_efficiency=0.6,
        frame_interval_s=0.5,
        growth_um_s=0.0,
    )
    write_experiment(tmp_path / "film", Film(scenario, 2), 60, with_images=False)
    seen = seen_of_truth(tmp_path / "film", radius_std=0.02)
    result = tracked(seen, tmp_path)
    found = coalescences(result.events, pixel_size_um=scenario.pixel_size_um)
    rows, fates = droplets_of_rows(seen, result.trajectories), Fates.read(tmp_path / "film")
    is_true, known = [], set()
    for event in found.iter_rows(named=True):
        before = rows.filter(pl.col("frame") < event["frame"])
        one, other = (
            before.filter(pl.col("trajectory_id") == event[name])["droplet_id"][-1] for name in ("parent_1", "parent_2")
        )
        became = fates.at(one, event["frame"])
        is_true.append(one != other and became == fates.at(other, event["frame"]))
        known.add(became)
    assert len(is_true) >= 5
    assert np.mean(is_true) >= 0.8
    large = large_coalescences(tmp_path / "film", fates)
    assert len(large) >= 10
    assert len(large & known) >= len(large) / 4


def test_a_droplet_that_takes_up_all_in_its_way_has_efficiency_one() -> None:
    """For small partners at rest the sum is phi u / 4, with phi their volume fraction."""
    stokes = {"delta_density_kg_m3": -100.0, "viscosity_pa_s": 1e-3}
    phi, small_um = 0.006, 0.01
    number = np.array([phi / (4 / 3 * np.pi * small_um**3)])
    swept = swept_growth_um_s(np.array([40.0]), np.array([small_um]), number, **stokes)
    assert swept[0] == pytest.approx(phi * 348.8 / 4, rel=2e-3)
    assert swept[0] == pytest.approx(0.52, abs=0.01)


def test_efficiency_is_measured_over_swept_growth(trajectories: pl.DataFrame) -> None:
    growth: Growth = growth_by_radius(trajectories, EDGES_UM)
    share, error = collision_efficiency(growth, np.where(growth.rate.x > 8, 0.1, 0.0))
    known = np.isfinite(share)
    np.testing.assert_allclose(share[known], growth.rate.mean[known] / 0.1)
    assert np.isnan(share[growth.rate.x <= 8]).all()
    assert np.isfinite(error[known & (growth.rate.n > 1)]).all()


def test_the_exponent_of_a_power_law_comes_back_with_its_error() -> None:
    rng = np.random.default_rng(8)
    driving = np.geomspace(3e-6, 1e-3, 40)
    law = period_law(driving, 2.0 * driving ** (-3 / 7) * np.exp(rng.normal(0, 0.2, 40)))
    assert abs(law.exponent + 3 / 7) < 3.5 * law.exponent_std
    assert law.exponent_std < 0.05
    assert np.isnan(period_law(np.array([1e-5]), np.array([100.0])).exponent)


def test_driving_is_grouped_as_in_the_figure() -> None:
    assert driving_group(np.array([1e-6, 1e-5, 2e-5, 5e-5, 1e-4, 1e-3])).tolist() == [0, 1, 2, 3, 4, 5]


def empty_trajectories(folder: Path) -> pl.DataFrame:
    pq.write_table(TRAJECTORIES.empty_table(), folder / "trajectories.parquet")
    return summarise_trajectories(open_trajectories(folder / "trajectories.parquet"))


def test_a_table_without_trajectories_gives_empty_statistics(tmp_path: Path) -> None:
    nothing = empty_trajectories(tmp_path)
    assert nothing.is_empty()
    assert velocity_by_radius(nothing, EDGES_UM).measured.n.sum() == 0
    assert radius_scatter(nothing, EDGES_UM).scatter.n.sum() == 0
    assert growth_by_radius(nothing, EDGES_UM).rate.n.sum() == 0
    assert trajectory_lengths(nothing, EDGES_UM, frame_height_um=1e3).counts.sum() == 0
    depth = observed_depth(nothing, EDGES_UM, frame_size_um=(1e3, 1e3), depth_speed_um_s=1.0, sideways_speed_um_s=1.0)
    assert np.isnan(depth.per_radius)
    found = self_calibration(
        tmp_path / "trajectories.parquet",
        nothing,
        (0.0, -1.0),
        field_um=(1e3, 1e3),
        density_over_viscosity_s_m2=np.full(3, 1e4),
    )
    assert found.n_rows == 0
    assert np.isnan(found.density_over_viscosity_s_m2)
    assert found.warning() is None


@pytest.mark.parametrize("n_frames", [0, 1, 5])
def test_a_film_too_short_to_oscillate_has_no_peaks(tmp_path: Path, n_frames: int) -> None:
    empty_trajectories(tmp_path)
    histograms: FrameHistograms = histograms_of_table(
        tmp_path / "trajectories.parquet", EDGES_UM, np.arange(n_frames, dtype=float)
    )
    assert len(find_oscillations(histograms).peak_s) == 0


def test_noise_does_not_oscillate_with_certainty() -> None:
    rng = np.random.default_rng(11)
    counts = rng.poisson(20, (400, 12))
    frames = np.arange(400)
    histograms = FrameHistograms(
        radius_edges_um(4, 40, 12), frames, frames, np.ones(400, int), frames * 1.0, counts, np.zeros((400, 4))
    )
    moments = counts @ np.stack([histograms.radius_um**k for k in range(4)], axis=1)
    noise = FrameHistograms(
        histograms.edges_um, frames, frames, histograms.n_frames, histograms.time_s, counts, moments
    )
    found = find_oscillations(noise)
    assert found.is_certain.sum() <= 0.3 * max(len(found.is_certain), 1)


def test_another_table_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ResultsError):
        open_trajectories(tmp_path / "missing.parquet")
    (tmp_path / "words.parquet").write_text("words")
    with pytest.raises(ResultsError):
        open_trajectories(tmp_path / "words.parquet")
    pl.DataFrame({"a": [1]}).write_parquet(tmp_path / "other.parquet")
    with pytest.raises(ResultsError, match="trajectory_id"):
        open_trajectories(tmp_path / "other.parquet")
    with pytest.raises(ResultsError):
        histograms_of_table(tmp_path / "other.parquet", EDGES_UM, np.arange(3.0))


def test_one_row_a_trajectory_holds_its_means_line_and_ends() -> None:
    rows = [(7, frame, 10.0 + 2 * frame, 50.0 - 3 * frame, 8.0 + 0.5 * frame) for frame in range(6)]
    (one,) = summarise_trajectories(table(rows)).to_dicts()
    assert one["n_frames"] == 6
    assert one["growth_um_s"] == pytest.approx(0.5)
    assert one["r_std_um"] == pytest.approx(0.0, abs=1e-6)
    assert one["rise_um_s"] == pytest.approx(3.0)
    assert one["aside_um_s"] == pytest.approx(2.0)
    assert (one["r_first_um"], one["r_last_um"]) == (8.5, 10.0)
