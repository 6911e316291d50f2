"""What a tracked film says of the sizes of its droplets."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from dropflow.tables import SIZE_COLUMNS
from tests.dropflow.tracking.generated import Film, film, vortices
from tests.dropflow.tracking.tracked import read, tracked

FLOW = vortices(4, 300, drift_px_s=(3, 0))


@pytest.fixture(params=["default", "paper"])
def method(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def places(x_px: npt.NDArray[np.float64], y_px: npt.NDArray[np.float64]) -> list[tuple[float, float]]:
    return list(zip(x_px.tolist(), y_px.tolist(), strict=True))


def with_matches(given: Film, match_of: dict[bool, float]) -> Film:
    """Droplets with even numbers match as `match_of[True]`, the others as `match_of[False]`."""
    frames = [
        replace(droplets, match=np.where(known % 2 == 0, match_of[True], match_of[False]))
        for droplets, known in zip(given.frames, given.truth, strict=True)
    ]
    return replace(given, frames=frames)


def test_smoothed_radii_are_nearer_to_the_truth_and_know_their_errors(method: str, tmp_path: Path) -> None:
    given, sure = (film(flow=FLOW, n_frames=20, radius_error=error) for error in (0.05, 0.0))
    table = read(tracked(given, tmp_path, method))
    known = [dict(zip(places(seen.x_px, seen.y_px), seen.r_px.tolist(), strict=True)) for seen in sure.frames]
    true_px = {place: r_px for frame in known for place, r_px in frame.items()}
    found = places(*(table[name].to_numpy() for name in ("x_px", "y_px")))
    true = np.array([true_px[place] for place in found]) * given.experiment.pixel_size_um
    smooth, single, std = (table[name].to_numpy() for name in ("r_smooth_um", "r_um", "r_smooth_std_um"))
    off = np.log(smooth / true)
    assert np.sqrt(np.mean(off**2)) < 0.5 * np.sqrt(np.mean(np.log(single / true) ** 2))
    assert 0.7 < np.sqrt(np.mean((off * smooth / std) ** 2)) < 1.4


def test_droplets_out_of_focus_are_followed_and_told_from_the_others(method: str, tmp_path: Path) -> None:
    """The links are those of the same film in which all droplets are sharp."""
    given = film(flow=FLOW, n_frames=10)
    blurred = read(tracked(with_matches(given, {True: 0.6, False: 0.2}), tmp_path / "blurred", method))
    sharp = read(tracked(with_matches(given, {True: 0.6, False: 0.6}), tmp_path / "sharp", method))
    assert pc.all(sharp["is_in_focus"]).as_py()
    np.testing.assert_array_equal(blurred["is_in_focus"], blurred["match"].to_numpy() > 0.5)
    own = [*SIZE_COLUMNS, "match"]
    assert blurred.drop_columns(own).equals(sharp.drop_columns(own))


def test_droplets_in_view_too_briefly_count_and_false_ones_at_the_ends_do_not(method: str, tmp_path: Path) -> None:
    """As many detections come to nothing in the first and the last frame as in each of the others."""
    given = film(flow=FLOW, n_frames=20, n_false=30)
    result = tracked(given, tmp_path, method)
    rejected = pq.read_table(result.rejected)
    brief = rejected.filter(pc.equal(rejected["reason"], "brief"))
    at_ends = (brief["first_frame"].to_numpy() == 0) | (brief["last_frame"].to_numpy() == 19)
    weight = brief["weight"].to_numpy()
    assert at_ends.sum() >= 50
    assert weight[at_ends].sum() < 30  # of the 60 false ones and those that leave or enter
    others = rejected.filter(pc.not_equal(rejected["reason"], "brief"))
    assert not others["weight"].to_numpy().any()
