from dataclasses import fields

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dropflow.errors import ParametersError, ResultsError
from dropflow.statistics.histograms import (
    FrameHistograms,
    coarsen,
    frame_histograms,
    merge,
    radius_edges_um,
)

EDGES_UM = radius_edges_um(4.0, 40.0, 6)


def droplet_table(frame: list[int], r_um: list[float]) -> pa.Table:
    return pa.table({"frame": pa.array(frame, pa.int32()), "r_um": pa.array(r_um, pa.float64())})


@st.composite
def histograms_of_frames(draw: st.DrawFn, n_frames: int = 12) -> FrameHistograms:
    n_droplets = draw(st.integers(0, 40))
    frame = draw(st.lists(st.integers(0, n_frames - 1), min_size=n_droplets, max_size=n_droplets))
    r_um = draw(st.lists(st.floats(1.0, 60.0), min_size=n_droplets, max_size=n_droplets))
    return frame_histograms(droplet_table(frame, r_um), EDGES_UM, range(n_frames), np.arange(n_frames) * 0.5)


def assert_same(one: FrameHistograms, other: FrameHistograms) -> None:
    for column in fields(FrameHistograms):
        np.testing.assert_allclose(getattr(one, column.name), getattr(other, column.name), rtol=1e-12)


@given(histograms_of_frames(), st.integers(0, 12), st.integers(0, 12), st.permutations([0, 1, 2]))
def test_merging_shards_in_any_order_and_grouping_gives_the_whole(
    whole: FrameHistograms, first: int, second: int, order: list[int]
) -> None:
    low, high = sorted((first, second))
    shards = [whole[:low], whole[low:high], whole[high:]]
    a, b, c = (shards[index] for index in order)
    assert_same(merge(merge(a, b), c), whole)
    assert_same(merge(a, merge(b, c)), whole)
    assert_same(merge(FrameHistograms.empty(EDGES_UM), a, c, b), whole)


@given(histograms_of_frames(), st.integers(1, 20))
def test_coarsening_keeps_every_total_and_the_limit(whole: FrameHistograms, max_columns: int) -> None:
    coarse = coarsen(whole, max_columns)
    assert len(coarse) <= max_columns
    assert coarse.n_frames.sum() == whole.n_frames.sum()
    np.testing.assert_array_equal(coarse.counts.sum(axis=0), whole.counts.sum(axis=0))
    np.testing.assert_allclose(coarse.moments.sum(axis=0), whole.moments.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(
        np.average(coarse.time_s, weights=coarse.n_frames), np.average(whole.time_s, weights=whole.n_frames)
    )


def test_each_droplet_is_counted_in_its_frame_and_bin() -> None:
    table = droplet_table([5, 5, 6, 8], [4.0, 40.0, 7.0, 100.0])
    counted = frame_histograms(table, EDGES_UM, range(5, 9), np.array([0.0, 1.0, 2.0, 3.0]))
    assert counted.counts[0, 0] == 1
    assert counted.counts[0, -1] == 1
    assert counted.counts.sum(axis=1).tolist() == [2, 1, 0, 0]
    assert counted.moments[:, 0].tolist() == [2, 1, 0, 1]
    assert counted.moments[1].tolist() == [1, 7, 49, 343]


def test_a_frame_in_two_shards_is_an_error_that_names_it() -> None:
    part = frame_histograms(droplet_table([], []), EDGES_UM, range(3, 6), np.arange(3.0))
    with pytest.raises(ResultsError, match="same frame") as caught:
        merge(part, part[1:])
    assert caught.value.frame == 4


def test_different_bins_do_not_merge() -> None:
    with pytest.raises(ResultsError, match="different radius bins"):
        merge(FrameHistograms.empty(EDGES_UM), FrameHistograms.empty(radius_edges_um(4.0, 40.0, 7)))


@pytest.mark.parametrize(("low", "high", "n_bins"), [(0, 40, 3), (40, 4, 3), (4, 40, 0)])
def test_impossible_bins_are_an_error(low: float, high: float, n_bins: int) -> None:
    with pytest.raises(ParametersError):
        radius_edges_um(low, high, n_bins)
