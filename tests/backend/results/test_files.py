"""Results: the same as the command's, frame by frame and as files, and as they appear."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
import zarr

from dropflow.experiment import parse_experiment
from tests.backend.results.figures import FIGURES
from tests.films import EXPERIMENT
from tests.house import House, Json
from worker.shards import look_at


def _download(house: House, run: Json, name: str) -> bytes:
    answer = house.api.get(f"runs/{run['id']}/files/{name}")
    assert answer.status_code == 200, answer.text
    assert int(answer.headers["content-length"]) == len(answer.content)
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}"'
    return answer.content


@pytest.mark.parametrize("name", ["droplets.parquet", "trajectories.parquet", "rejected_trajectories.parquet"])
def test_tables_are_those_of_the_command(shared_house: House, run: Json, by_command: Path, name: str) -> None:
    mine = pq.read_table(io.BytesIO(_download(shared_house, run, name)))
    theirs = pq.read_table(by_command / name)
    assert mine.schema == theirs.schema
    assert mine.equals(theirs)


def test_the_summary_is_that_of_the_command(shared_house: House, run: Json, by_command: Path) -> None:
    mine = json.loads(_download(shared_house, run, "summary.json"))
    theirs = json.loads((by_command / "summary.json").read_text())
    # The stack's checksum counts names as well, and uploads keep their folder's.
    for summary in (mine, theirs, run["summary"]):
        summary["provenance"].pop("input_sha256")
    assert mine == theirs == run["summary"]


def test_the_flow_field_is_that_of_the_command(
    shared_house: House, run: Json, by_command: Path, tmp_path: Path
) -> None:
    with zipfile.ZipFile(io.BytesIO(_download(shared_house, run, "flow.zarr.zip"))) as archive:
        assert archive.testzip() is None
        archive.extractall(tmp_path)
    mine, theirs = (
        zarr.open_group(tmp_path / "flow.zarr", mode="r"),
        zarr.open_group(by_command / "flow.zarr", mode="r"),
    )
    assert set(mine.array_keys()) == set(theirs.array_keys())
    for name in mine.array_keys():
        assert np.array_equal(np.asarray(mine[name]), np.asarray(theirs[name]), equal_nan=True)


def test_the_list_of_files_tells_their_true_sizes(shared_house: House, run: Json) -> None:
    items = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/files"))["items"]
    names = {item["name"] for item in items}
    assert names == {
        "droplets.parquet",
        "trajectories.parquet",
        "rejected_trajectories.parquet",
        "events.parquet",
        "flow.zarr.zip",
        "summary.json",
        "trajectory_summary.parquet",
        "coalescences.parquet",
        "statistics.npz",
        "example.npz",
        "report.html",
    }
    for item in items:
        assert len(_download(shared_house, run, item["name"])) == item["size_bytes"]


def test_droplets_of_a_frame_are_the_rows_of_the_tables(shared_house: House, run: Json, by_command: Path) -> None:
    rows = pq.read_table(by_command / "droplets.parquet", filters=[("frame", "=", 3)])
    shown = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/3/droplets"))
    assert shown["x_px"] == rows["x_px"].to_pylist()
    assert shown["match"] == rows["match"].to_pylist()
    assert shown["trajectory_id"] is None

    rows = pq.read_table(by_command / "trajectories.parquet", filters=[("frame", "=", 3)])
    tracked = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/3/droplets?which=tracked"))
    assert tracked["trajectory_id"] == rows["trajectory_id"].to_pylist()
    assert tracked["r_px"] == rows["r_px"].to_pylist()
    later = pq.read_table(by_command / "trajectories.parquet", filters=[("frame", "=", 4)])
    places = dict(zip(later["trajectory_id"].to_pylist(), later["x_px"].to_pylist(), strict=True))
    assert tracked["next_x_px"] == [places.get(found) for found in tracked["trajectory_id"]]
    assert any(place is not None for place in tracked["next_x_px"])


def test_in_the_last_frame_nothing_goes_on(shared_house: House, run: Json) -> None:
    tracked = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/5/droplets?which=tracked"))
    assert tracked["x_px"]
    assert set(tracked["next_x_px"]) == {None}


def test_the_flow_of_a_frame_is_the_entry_of_the_field(shared_house: House, run: Json, by_command: Path) -> None:
    shown = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/2/flow"))
    group = zarr.open_group(by_command / "flow.zarr", mode="r")
    assert np.array_equal(np.array(shown["u_um_s"]), np.asarray(group["velocity_um_s"])[2, 0])
    assert np.array_equal(np.array(shown["droplet_count"]), np.asarray(group["droplet_count"])[2])
    assert (len(shown["grid_x_px"]), len(shown["grid_y_px"])) == (5, 4)
    assert shared_house.api.get(f"runs/{run['id']}/frames/5/flow").status_code == 404


def test_the_report_is_among_the_files(shared_house: House, run: Json) -> None:
    page = _download(shared_house, run, "report.html").decode()
    assert page.startswith("<!doctype html>")
    assert page.count("<figure id=") == len(FIGURES)


@pytest.mark.parametrize(
    "path", ["figures/pie", "files/secrets.txt", "files/..%2f..%2fetc", "frames/6/droplets", "frames/99/flow"]
)
def test_what_is_not_there_is_not_found(shared_house: House, run: Json, path: str) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/{path}")
    assert answer.status_code in {404, 422}
    assert answer.headers["content-type"] == "application/problem+json"


def test_the_document_of_the_results_is_the_experiment_s(shared_house: House, run: Json) -> None:
    summary = json.loads(_download(shared_house, run, "summary.json"))
    said = summary["provenance"]["experiment"]
    assert said == parse_experiment(yaml.safe_load(yaml.safe_dump(EXPERIMENT))).model_dump(mode="json")
    assert summary["provenance"]["parameters"] == run["parameters"]


def test_results_appear_while_the_run_goes(house: House) -> None:
    run = house.start(house.ready())
    for name in FIGURES:
        answer = house.api.get(f"runs/{run['id']}/figures/{name}")
        assert (answer.status_code, answer.json()["code"]) == (404, "results.not_yet")
    assert house.ok(house.api.get(f"runs/{run['id']}/files"))["items"] == []
    look_at(house.context, house.waiting("prepare")[0])
    for shard_id in house.waiting("detect")[1:3]:
        look_at(house.context, shard_id)
    assert house.api.get(f"runs/{run['id']}/figures/size_distribution_before").status_code == 200
    assert house.api.get(f"runs/{run['id']}/figures/moments").status_code == 200
    listed = house.ok(house.api.get(f"runs/{run['id']}/figures"))["items"]
    there = [item["name"] for item in listed if item["is_available"]]
    assert there == ["size_distribution_before", "size_distribution_at", "moments"]
    assert house.api.get(f"runs/{run['id']}/figures/size_distribution_after").status_code == 404
    assert house.api.get(f"runs/{run['id']}/frames/1/droplets").status_code == 200
    assert house.api.get(f"runs/{run['id']}/frames/0/droplets").status_code == 404
    missing = house.api.get(f"runs/{run['id']}/files/trajectories.parquet")
    assert (missing.status_code, missing.json()["code"]) == (404, "results.not_yet")
