"""Results of an analysis that made no mistake, from the truth of a simulated film."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from dropflow.parameters import Parameters
from dropflow.provenance import UNITS, code_version
from dropflow.simulation.oscillating import OSCILLATING, Waves, write_oscillating
from dropflow.simulation.scenario import Scenario, changed
from dropflow.tables import DROPLETS
from dropflow.tracking.events import EVENTS
from tests.dropflow.statistics.truth import write_as_trajectories

WAVES = Waves(n_waves=4, period_s=30.0, growth_um_s=0.3)
SCENARIO = changed(OSCILLATING, {"height_px": 600, "width_px": 700, "n_droplets": 900})
NAME = "waves </script><b>&"


def write_results(folder: Path, film: Path, scenario: Scenario, *, experiment: dict[str, Any] | None = None) -> None:
    """A folder of results from a simulated film."""
    folder.mkdir()
    write_as_trajectories(film / "truth.parquet", folder / "trajectories.parquet", radius_std=0.03)
    rows = pq.read_table(folder / "trajectories.parquet")
    pq.write_table(rows.select(DROPLETS.names).sort_by("frame"), folder / "droplets.parquet")
    pq.write_table(EVENTS.empty_table(), folder / "events.parquet")
    shutil.copytree(film / "truth_flow.zarr", folder / "flow.zarr")
    document = yaml.safe_load((film / "experiment.yaml").read_text()) | {"name": NAME} | (experiment or {})
    n_frames = int(yaml.safe_load((film / "scenario.yaml").read_text())["n_frames"])
    radius_um = rows["r_um"].to_numpy()
    sizes = {
        "n_droplets": len(rows),
        "mean_radius_um": float(radius_um.mean()) if len(rows) else None,
        "sauter_radius_um": float((radius_um**3).sum() / (radius_um**2).sum()) if len(rows) else None,
    }
    summary = {
        "n_frames": n_frames,
        "duration_s": float((n_frames - 1) * scenario.frame_interval_s),
        "field_of_view_um": [scenario.width_px * scenario.pixel_size_um, scenario.height_px * scenario.pixel_size_um],
        "detected": sizes,
        "tracked": sizes | {"found_by_prediction_share": 0.0, "out_of_focus_share": 0.0, "n_counted": float(len(rows))},
        "n_rejected_trajectories": {"short": 3},
        "provenance": {
            "dropflow_version": code_version(),
            "parameters": Parameters().model_dump(mode="json"),
            "experiment": document,
            "input_sha256": "0" * 64,
            "n_frames": n_frames,
            "units": UNITS,
        },
    }
    (folder / "summary.json").write_text(json.dumps(summary))


@pytest.fixture(scope="session")
def results_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    base = tmp_path_factory.mktemp("report")
    write_oscillating(base / "film", scenario=SCENARIO, waves=WAVES, with_images=False, seed=6)
    write_results(base / "results", base / "film", SCENARIO)
    return base / "results"


@pytest.fixture(scope="session")
def short_results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One frame: no trajectory, no flow."""
    base = tmp_path_factory.mktemp("short")
    write_oscillating(base / "film", scenario=SCENARIO, waves=WAVES, with_images=False, seed=6, n_frames=1)
    write_results(base / "results", base / "film", SCENARIO)
    return base / "results"


@pytest.fixture(scope="session")
def still_rows(results_folder: Path) -> int:
    return int(np.asarray(pq.read_metadata(results_folder / "trajectories.parquet").num_rows))
