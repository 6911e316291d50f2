import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from dropflow.cli import main
from dropflow.simulation.oscillating import OSCILLATING, Waves, wave_clouds, wave_flow
from dropflow.simulation.scenario import changed

SCENARIO = changed(OSCILLATING, {"height_px": 400, "width_px": 500, "n_droplets": 1500})
WAVES = Waves(n_waves=3, period_s=20.0)


def test_waves_follow_each_other_in_shortening_periods() -> None:
    periods = np.diff(WAVES.starts_s)
    np.testing.assert_allclose(periods[1:] / periods[:-1], WAVES.period_ratio)
    assert WAVES.starts_s[1] == 0
    assert WAVES.phase(0.0) == 0
    assert WAVES.phase(10.0) == pytest.approx(0.5)


def test_droplets_grow_in_proportion_and_keep_their_ids() -> None:
    clouds = list(wave_clouds(SCENARIO, WAVES, 6, seed=1))
    for before, after in pairwise(clouds):
        assert (np.diff(after.droplet_id) > 0).all()
        _, old, new = np.intersect1d(before.droplet_id, after.droplet_id, return_indices=True)
        assert len(old) > 0.5 * len(before)
        growth = after.r_um[new] - before.r_um[old]
        median = WAVES.growth_um_s * SCENARIO.frame_interval_s
        assert (growth > 0).all()
        assert np.median(growth) == pytest.approx(median, rel=0.1)


def test_the_fluid_around_is_as_full_as_the_volume_in_every_direction() -> None:
    """Droplets per fifth of the width, the height and the depth are the same within 5 sigma."""
    counts = np.zeros((3, 5))
    for cloud in wave_clouds(SCENARIO, WAVES, 40, seed=2):
        for axis, values in enumerate((cloud.x_um, cloud.y_um, cloud.z_um)):
            counts[axis] += np.histogram(values, bins=5, range=(values.min(), values.max()))[0]
    for row in counts:
        # A droplet is counted in about twelve frames of its life.
        assert (np.abs(row - row.mean()) < 5 * np.sqrt(12 * row.mean())).all()


def test_the_flow_beats_and_stays_free_of_divergence() -> None:
    flow = wave_flow(SCENARIO, WAVES, 3)
    step = 0.5
    for time_s in (3.0, 11.0):

        def at(dx: float, dy: float, time_s: float = time_s) -> np.ndarray:
            return flow.velocity_um_s(np.array([100.0 + dx]), np.array([120.0 + dy]), time_s)[:, 0]

        divergence = (at(step, 0)[0] - at(-step, 0)[0] + at(0, step)[1] - at(0, -step)[1]) / (2 * step)
        assert abs(divergence) < 1e-3
    rng = np.random.default_rng(0)
    places = rng.uniform(0, 2000, (2, 400))
    rms = [float(flow.velocity_um_s(*places, time_s)[0].std()) for time_s in (0.0, 10.0)]
    assert rms[1] > 2 * rms[0]


def test_the_command_simulates_waves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["--scenario", "oscillating", "--frames", "3", "--height", "300", "--width", "320", "--tables-only"]
    monkeypatch.setattr(sys, "argv", ["dropflow", "simulate", str(tmp_path / "film"), *words])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert pl.read_parquet(tmp_path / "film" / "truth.parquet")["frame"].n_unique() == 3
