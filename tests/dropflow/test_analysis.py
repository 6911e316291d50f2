"""The whole analysis from the command line: results, restarts, and what bad input leaves behind."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import tifffile
import yaml
import zarr

from dropflow import tables
from dropflow.cli import main
from dropflow.pipeline import RESULT_FILES

DROPFLOW = [sys.executable, "-c", "from dropflow.cli import main; main()"]


def run(*arguments: str | int | Path) -> str:
    """Run the command as a user does; return what it prints."""
    done = subprocess.run([*DROPFLOW, *map(str, arguments)], capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated film of 24 small frames."""
    folder = tmp_path_factory.mktemp("simulated") / "film"
    run("simulate", folder, "--scenario", "easy", "--frames", 24, "--seed", 5, "--height", 320, "--width", 384)
    return folder


@pytest.fixture(scope="module")
def results(film: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The film, analysed in one process without disturbance."""
    folder = tmp_path_factory.mktemp("results") / "one"
    run("analyse", film / "frames", "--experiment", film / "experiment.yaml", "--output", folder, "--jobs", 1)
    return folder


def digest(folder: Path) -> dict[str, str]:
    """SHA-256 of every result file."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_the_results_are_what_the_contract_promises(film: Path, results: Path) -> None:
    assert sorted(path.name for path in results.iterdir()) == sorted(RESULT_FILES)
    droplets, trajectories = (pq.read_table(results / f"{name}.parquet") for name in ("droplets", "trajectories"))
    assert droplets.schema.equals(tables.DROPLETS)
    assert trajectories.schema.equals(tables.TRAJECTORIES)
    assert len(droplets) > 24
    assert len(trajectories) > 24
    flow = zarr.open_group(results / "flow.zarr", mode="r")
    assert flow["velocity_um_s"].shape == (23, 2, 20, 25)
    assert {"velocity_std_um_s", "droplet_count", "is_interpolated", "grid_x_px", "grid_y_px"} <= set(flow.keys())


def test_each_result_says_where_it_comes_from(film: Path, results: Path) -> None:
    summary = json.loads((results / "summary.json").read_text())
    inside = json.loads(pq.read_schema(results / "trajectories.parquet").metadata[b"dropflow"])
    assert summary["provenance"] == inside
    assert {"dropflow_version", "parameters", "experiment", "input_sha256", "units"} <= inside.keys()
    assert inside["experiment"]["name"] == yaml.safe_load((film / "experiment.yaml").read_text())["name"]


def test_two_processes_give_the_same_bytes_as_one(film: Path, results: Path, tmp_path: Path) -> None:
    run("analyse", film / "frames", "--experiment", film / "experiment.yaml", "-o", tmp_path / "two", "--jobs", 2)
    assert digest(tmp_path / "two") == digest(results)


def test_a_killed_analysis_goes_on_and_ends_with_the_same_bytes(film: Path, results: Path, tmp_path: Path) -> None:
    output = tmp_path / "killed"
    command = ["analyse", film / "frames", "--experiment", film / "experiment.yaml", "-o", output, "--jobs", "1"]
    process = subprocess.Popen([*DROPFLOW, *map(str, command)], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while not list(output.glob(".dropflow-*/shard-*.parquet")) and time.monotonic() < deadline:
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    made_before = {path.name for path in output.glob(".dropflow-*/*")}
    assert made_before, "the kill came too late to leave anything to go on from"
    assert not (output / "summary.json").exists()
    run(*command)
    assert digest(output) == digest(results)


def test_detect_writes_the_same_droplets_as_analyse(film: Path, results: Path, tmp_path: Path) -> None:
    table = tmp_path / "only" / "droplets.parquet"
    run("detect", film / "frames", "--experiment", film / "experiment.yaml", "--output", table)
    assert pq.read_table(table).equals(pq.read_table(results / "droplets.parquet"))
    assert [path.name for path in table.parent.iterdir()] == ["droplets.parquet"]


def test_results_are_scored_against_the_truth(film: Path, results: Path) -> None:
    score = json.loads(run("score", results, "--truth", film / "truth.parquet", "--json"))
    assert score["tracked"]["recall"] > 0.8
    assert score["missing"] == []


@pytest.fixture
def fails_with(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Run the command in this process; it must end with exit code 2 and one line, which is returned."""

    def fails(*arguments: str | Path) -> str:
        monkeypatch.setattr(sys, "argv", ["dropflow", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 2
        said = capsys.readouterr().err.splitlines()
        lines = [line for line in said if not line.startswith(("ingest:", "detect:", "track:"))]
        assert len(lines) == 1, said
        return lines[0]

    return fails


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"pixel_size_um": 0}, "pixel_size_um"),
        ({"pixel_size_um": None}, "pixel_size_um"),
        ({"frame_interval_s": None}, "frame_interval_s"),
        ({"material": None}, "material"),
        ({"material": "nobody knows this"}, "material"),
        ({"colour": "blue"}, "colour"),
        ({"flat_field": "missing.tif"}, "flat_field"),
    ],
)
def test_a_wrong_experiment_is_one_line_that_names_the_field_and_leaves_nothing(
    film: Path, tmp_path: Path, fails_with: Callable[..., str], change: dict[str, object], field: str
) -> None:
    content = yaml.safe_load((film / "experiment.yaml").read_text()) | {"flat_field": None} | change
    path = tmp_path / "experiment.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in content.items() if value is not None}))
    assert field in fails_with("analyse", film / "frames", "--experiment", path, "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_radius_range_that_does_not_fit_the_frame_names_the_parameter(
    film: Path, tmp_path: Path, fails_with: Callable[..., str]
) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text("detection: {radius_min_um: 100, radius_max_um: 4000}\n")
    options = ["--experiment", film / "experiment.yaml", "--parameters", path, "-o", tmp_path / "out"]
    assert "detection.radius_max_um" in fails_with("analyse", film / "frames", *options)
    assert not (tmp_path / "out").exists()


def test_a_broken_frame_in_the_middle_names_it_and_leaves_nothing(
    film: Path, tmp_path: Path, fails_with: Callable[..., str]
) -> None:
    frames = tmp_path / "frames"
    frames.mkdir()
    for number in range(12):
        tifffile.imwrite(frames / f"{number}.tif", tifffile.imread(film / "flat_field.tif"))
    broken = frames / "9.tif"
    broken.write_bytes(broken.read_bytes()[:-100])
    options = ["--experiment", film / "experiment.yaml", "-o", tmp_path / "out", "--jobs", "2"]
    assert "frame 9" in fails_with("analyse", frames, *options)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["analyse", "detect", "simulate", "score"])
def test_every_command_has_help_with_an_example(command: str) -> None:
    assert f"dropflow {command}" in run(command, "--help")
