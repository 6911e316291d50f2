"""Which droplets count after tracking, and in which bins."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from dropflow.errors import ResultsError
from dropflow.statistics.expected_counts import shares_of_bins
from dropflow.statistics.table_histograms import histograms_after_tracking

EDGES_UM = np.array([4.0, 6.0, 9.0, 13.5])
TIMES_S = np.arange(4.0)
SIZES = {"r_smooth_um": [5.0, 5.0, 8.0], "r_smooth_std_um": [0.0] * 3, "is_in_focus": [True, True, False]}


def write(folder: Path, *, sizes: dict[str, list[float]] | None, brief: bool = False) -> None:
    """Three rows; and where asked for two brief droplets, one of them in two frames and half probable."""
    places = {"frame": pa.array([0, 1, 1], pa.int32()), "x_px": [1.0, 2.0, 9.0], "y_px": [0.0] * 3}
    radii = {"r_px": [14.0, 10.0, 16.0], "r_um": [7.0, 5.0, 8.0]}
    pq.write_table(pa.table({**places, **radii, **(sizes or {})}), folder / "trajectories.parquet")
    if brief:
        ends = {"first_frame": pa.array([2, 0], pa.int32()), "last_frame": pa.array([3, 0], pa.int32())}
        where = {name: [10.0, 20.0] for name in ("x_px", "y_px", "last_x_px", "last_y_px")}
        judged = {"reason": ["brief", "short"], "is_in_focus": [True, True], "weight": [0.5, 0.0]}
        pq.write_table(
            pa.table({**ends, **where, "r_px": [20.0, 20.0], **judged}), folder / "rejected_trajectories.parquet"
        )


def counts(folder: Path, *, out_of_focus: bool = False) -> list[list[float]]:
    found = histograms_after_tracking(folder, EDGES_UM, TIMES_S, pixel_size_um=0.5, out_of_focus=out_of_focus)
    np.testing.assert_allclose(found.moments[:, 0], found.counts.sum(axis=1))
    return list(found.counts.tolist())


def test_droplets_in_focus_count_with_the_radius_of_the_trajectory(tmp_path: Path) -> None:
    write(tmp_path, sizes=SIZES)
    assert counts(tmp_path) == [[1, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 0]]


def test_droplets_out_of_focus_count_when_asked_for(tmp_path: Path) -> None:
    write(tmp_path, sizes=SIZES)
    assert counts(tmp_path, out_of_focus=True) == [[1, 0, 0], [1, 1, 0], [0, 0, 0], [0, 0, 0]]


def test_a_table_of_an_older_version_counts_single_frames_and_all(tmp_path: Path) -> None:
    write(tmp_path, sizes=None)
    assert counts(tmp_path) == [[0, 1, 0], [1, 1, 0], [0, 0, 0], [0, 0, 0]]


def test_brief_droplets_count_as_much_as_they_are_probable_in_each_of_their_frames(tmp_path: Path) -> None:
    write(tmp_path, sizes=SIZES, brief=True)
    assert counts(tmp_path) == [[1, 0, 0], [1, 0, 0], [0, 0, 0.5], [0, 0, 0.5]]


def test_an_uncertain_radius_is_spread_over_bins(tmp_path: Path) -> None:
    """One at an edge is half in either bin, and in the sum nothing is lost."""
    write(tmp_path, sizes=SIZES | {"r_smooth_um": [6.0, 5.0, 8.0], "r_smooth_std_um": [0.1, 0.0, 0.0]})
    found = counts(tmp_path)
    assert found[0][:2] == pytest.approx([0.5, 0.5], abs=1e-6)


def test_shares_of_a_droplet_add_up_to_one_over_all_bins() -> None:
    rng = np.random.default_rng(0)
    radius, std = rng.uniform(2, 20, 200), rng.uniform(0, 3, 200) * rng.integers(0, 2, 200)
    total, by_bin = np.zeros(200), np.zeros((200, 5))
    for which, radius_bin, share in shares_of_bins(radius, std, EDGES_UM):
        total[which] += share
        by_bin[which, radius_bin] += share
    np.testing.assert_allclose(total, 1.0)
    sharp = std == 0
    np.testing.assert_array_equal(by_bin[sharp].argmax(axis=1), np.searchsorted(EDGES_UM, radius[sharp], side="right"))
    assert (by_bin >= 0).all()


def test_frames_beyond_the_film_are_an_error(tmp_path: Path) -> None:
    write(tmp_path, sizes=SIZES)
    with pytest.raises(ResultsError, match="beyond"):
        histograms_after_tracking(tmp_path, EDGES_UM, TIMES_S[:1], pixel_size_um=0.5)
