"""Single droplets and their tails: what the table of trajectories says, and nothing for what is not there."""

import io

import numpy as np
import polars as pl
import pytest

from tests.house import House, Json


@pytest.fixture(scope="module")
def run(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


@pytest.fixture(scope="module")
def table(shared_house: House, run: Json) -> pl.DataFrame:
    content = shared_house.api.get(f"runs/{run['id']}/files/trajectories.parquet").content
    return pl.read_parquet(io.BytesIO(content))


def test_a_trajectory_is_the_rows_of_the_table(shared_house: House, run: Json, table: pl.DataFrame) -> None:
    longest = table.group_by("trajectory_id").len().sort("len", "trajectory_id")["trajectory_id"][-1]
    rows = table.filter(pl.col("trajectory_id") == longest).sort("frame")
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/trajectories/{longest}"))
    for name in ("frame", "time_s", "x_px", "y_px", "r_um", "is_detected"):
        assert found[name] == rows[name].to_list()
    for name in ("u_um_s", "v_um_s", "sedimentation_um_s", "match"):
        assert np.allclose(np.array(found[name], float), rows[name].to_numpy(), equal_nan=True)
    pixel_size_um = run["summary"]["provenance"]["experiment"]["pixel_size_um"]
    assert np.allclose(np.array(found["r_std_um"], float), rows["r_std_px"] * pixel_size_um, equal_nan=True)


def test_tails_lead_to_the_droplets_of_the_frame(shared_house: House, run: Json, table: pl.DataFrame) -> None:
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/4/tails", params={"n_frames": 2}))
    here = table.filter(pl.col("frame") == 4).sort("trajectory_id")
    assert found["trajectory_id"] == here["trajectory_id"].to_list()
    ends = np.array(found["offsets"][1:]) - 1
    assert np.array_equal(np.array(found["x_px"])[ends], here["x_px"])
    assert np.array_equal(np.array(found["y_px"])[ends], here["y_px"])
    near = table.filter(pl.col("frame").is_between(2, 4) & pl.col("trajectory_id").is_in(found["trajectory_id"]))
    assert len(found["x_px"]) == found["offsets"][-1] == near.height > here.height


def test_there_is_no_tail_before_the_first_frame(shared_house: House, run: Json, table: pl.DataFrame) -> None:
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/0/tails"))
    assert found["offsets"][-1] == table.filter(pl.col("frame") == 0).height


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("trajectories/999999999", 404, "not_found.trajectory"),
        ("trajectories/first", 422, "request.invalid"),
        ("frames/0/tails?n_frames=0", 422, "request.invalid"),
        ("frames/99/tails", 404, "results.not_yet"),
    ],
)
def test_what_is_not_there_is_said_so(shared_house: House, run: Json, path: str, status: int, code: str) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/{path}")
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_nothing_is_there_before_tracking(shared_house: House) -> None:
    early = shared_house.start(shared_house.ready(name="not tracked yet"))
    for path in ("trajectories/0", "frames/0/tails"):
        answer = shared_house.api.get(f"runs/{early['id']}/{path}")
        assert (answer.status_code, answer.json()["code"]) == (404, "results.not_yet")
    shared_house.work()
