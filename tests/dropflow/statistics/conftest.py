from pathlib import Path

import polars as pl
import pytest

from dropflow.simulation.oscillating import OSCILLATING, Waves, write_oscillating
from dropflow.simulation.scenario import changed
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories
from tests.dropflow.statistics.truth import write_as_trajectories

RADIUS_STD = 0.03
WAVES = Waves(n_waves=4, period_s=48.0, growth_um_s=0.25)
SCENARIO = changed(OSCILLATING, {"height_px": 900, "width_px": 1100, "n_droplets": 800})


@pytest.fixture(scope="session")
def waves_film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four waves of nucleation: the truth, and trajectories as flawless tracking would give them."""
    folder = tmp_path_factory.mktemp("waves") / "film"
    write_oscillating(folder, scenario=SCENARIO, waves=WAVES, with_images=False, seed=4)
    write_as_trajectories(folder / "truth.parquet", folder / "trajectories.parquet", radius_std=RADIUS_STD)
    return folder


@pytest.fixture(scope="session")
def trajectories(waves_film: Path) -> pl.DataFrame:
    return summarise_trajectories(open_trajectories(waves_film / "trajectories.parquet"))
