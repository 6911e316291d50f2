"""Along a temperature ramp droplets sediment ever faster: tracking predicts with the material of each frame."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from dropflow.parameters import parse_parameters
from dropflow.physics.over_time import MaterialOverTime
from dropflow.tracking.film import Film
from dropflow.tracking.track import TrackingResult, track_film
from tests.dropflow.tracking.generated import film, vortices
from tests.dropflow.tracking.tracked import link_scores

STRENGTH = np.geomspace(1.0, 12.0, 14)
"""From the beginning of a ramp to its end droplets rise this many times faster."""


@pytest.fixture(scope="module")
def given():
    return film(flow=vortices(1.5, 300.0), n_frames=len(STRENGTH), n_droplets=250, strength=STRENGTH, seed=5)


def track(given, folder: Path, material: MaterialOverTime | None, method: str) -> TrackingResult:
    source = Film(given.times_s, given, None, None, material)
    parameters = parse_parameters({"tracking": {"method": method}})
    return track_film(source, given.shape, given.experiment, parameters, folder, {}, lambda *_: None)


@pytest.mark.parametrize("method", ["paper", "default"])
def test_the_material_of_each_frame_finds_what_that_of_the_first_loses(given, tmp_path: Path, method: str) -> None:
    first = given.experiment.material
    changing = MaterialOverTime(first.delta_density_kg_m3 * STRENGTH, np.full(len(STRENGTH), first.viscosity_pa_s))
    with_it = track(given, tmp_path / "with", changing, method)
    without = track(given, tmp_path / "without", None, method)
    rows, fewer = (pq.read_table(found.trajectories) for found in (with_it, without))
    assert link_scores(given, rows)[1] > 0.95
    assert link_scores(given, rows)[1] >= link_scores(given, fewer)[1]
    # The column of Stokes velocities is that of each frame's own material.
    frame, r_um = rows["frame"].to_numpy(), rows["r_um"].to_numpy()
    by_r2 = np.array([np.median((rows["sedimentation_um_s"].to_numpy() / r_um**2)[frame == i]) for i in (2, 11)])
    assert by_r2[1] / by_r2[0] == pytest.approx(STRENGTH[11] / STRENGTH[2], rel=0.05)
