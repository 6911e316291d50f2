"""Maps of the flow and quality over time: the same as the tables say, at any range and resolution."""

import io
import zipfile
from pathlib import Path
from uuid import UUID

import numpy as np
import polars as pl
import pytest
import zarr
from sqlalchemy import select

from backend.models import Product, Shard
from backend.platform.object_store import QUALITY_BY_RADIUS_FILE
from tests.house import House, Json


@pytest.fixture(scope="module")
def run(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


@pytest.fixture(scope="module")
def flow(shared_house: House, run: Json, tmp_path_factory: pytest.TempPathFactory) -> zarr.Group:
    folder: Path = tmp_path_factory.mktemp("flow")
    with zipfile.ZipFile(io.BytesIO(_file(shared_house, run, "flow.zarr.zip"))) as archive:
        archive.extractall(folder)
    return zarr.open_group(folder / "flow.zarr", mode="r")


def _file(house: House, run: Json, name: str) -> bytes:
    return house.api.get(f"runs/{run['id']}/files/{name}").content


def _numbers(values: list[list[float | None]]) -> np.ndarray:
    return np.array(values, float)


def test_a_step_is_the_flow_field_of_that_step(shared_house: House, run: Json, flow: zarr.Group) -> None:
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/flow_map", params={"frame": 2}))
    velocity = np.asarray(flow["velocity_um_s"][2])
    assert np.allclose(_numbers(found["u_um_s"]), velocity[0], equal_nan=True)
    assert np.allclose(_numbers(found["speed_um_s"]), np.hypot(*velocity), equal_nan=True)
    assert (found["first_frame"], found["last_frame"], found["n_steps"]) == (2, 2, 1)
    assert len(found["vorticity_per_s"]) == len(found["grid_y_px"])


def test_a_range_is_the_mean_of_its_computed_cells(shared_house: House, run: Json, flow: zarr.Group) -> None:
    time_s = np.asarray(flow["time_s"][:])
    asked = {"from_s": time_s[1], "to_s": time_s[3]}
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/flow_map", params=asked))
    assert (found["first_frame"], found["last_frame"], found["n_used"]) == (1, 3, 3)
    u = np.asarray(flow["velocity_um_s"][1:4, 0])
    is_computed = ~np.asarray(flow["is_interpolated"][1:4])
    n_computed = is_computed.sum(axis=0)
    mean = np.where(is_computed, u, 0).sum(axis=0)[n_computed > 0] / n_computed[n_computed > 0]
    assert np.allclose(_numbers(found["u_um_s"])[n_computed > 0], mean)
    assert np.isnan(_numbers(found["u_um_s"])[n_computed == 0]).all()


@pytest.mark.parametrize("asked", [{"frame": 99}, {"frame": -1}, {"from_s": "nan"}])
def test_a_map_that_cannot_be_is_refused(shared_house: House, run: Json, asked: Json) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/flow_map", params=asked)
    assert (answer.status_code, answer.json()["code"]) in [(404, "results.not_yet"), (422, "request.invalid")]


def test_quality_counts_what_the_tables_hold(shared_house: House, run: Json) -> None:
    found = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/quality"))
    droplets = pl.read_parquet(io.BytesIO(_file(shared_house, run, "droplets.parquet")))
    tracked = pl.read_parquet(io.BytesIO(_file(shared_house, run, "trajectories.parquet")))
    frames = range(len(found["time_s"]))
    assert found["n_detected"] == [droplets.filter(pl.col("frame") == frame).height for frame in frames]
    assert found["n_tracked"] == [tracked.filter(pl.col("frame") == frame).height for frame in frames]
    here = tracked.filter(pl.col("frame") == 2)
    assert found["predicted_share"][2] == pytest.approx((~here["is_detected"]).sum() / here.height)
    assert found["match"][2] == pytest.approx(here.filter(pl.col("is_detected"))["match"].mean())
    assert 0 < found["residual_px"][2] < 5
    assert found["residual_px"][-1] is None


def test_coarser_columns_keep_the_totals(shared_house: House, run: Json) -> None:
    address = f"runs/{run['id']}/quality"
    fine = shared_house.ok(shared_house.api.get(address))
    coarse = shared_house.ok(shared_house.api.get(address, params={"max_columns": 2}))
    assert len(coarse["time_s"]) == 2
    first = len(fine["time_s"]) // 2 + len(fine["time_s"]) % 2
    assert coarse["n_tracked"][0] == pytest.approx(np.mean(fine["n_tracked"][:first]))
    nothing = shared_house.ok(shared_house.api.get(address, params={"from_s": 1e9}))
    assert nothing["time_s"] == []


def test_quality_of_a_range_of_radius_is_of_its_droplets(shared_house: House, run: Json) -> None:
    address = f"runs/{run['id']}/quality"
    every = shared_house.ok(shared_house.api.get(address))
    assert (every["is_of_radii"], every["trajectories"]) == (True, None)
    detection = run["parameters"]["detection"]
    edges_um = np.geomspace(detection["radius_min_um"], detection["radius_max_um"], 49)
    tracked = pl.read_parquet(io.BytesIO(_file(shared_house, run, "trajectories.parquet")))
    split = int(np.searchsorted(edges_um, tracked["r_um"].median()))
    limits = {"radius_min_um": edges_um[0], "radius_max_um": edges_um[split]}
    small = shared_house.ok(shared_house.api.get(address, params=limits))
    inside = tracked.filter(pl.col("r_um").is_between(edges_um[0], edges_um[split], closed="left"))
    frames = range(len(every["time_s"]))
    assert small["is_of_radii"]
    assert small["n_tracked"] == [inside.filter(pl.col("frame") == frame).height for frame in frames]
    here = inside.filter((pl.col("frame") == 2) & pl.col("is_detected"))
    assert small["match"][2] == pytest.approx(here["match"].mean())
    detected = pl.read_parquet(io.BytesIO(_file(shared_house, run, "droplets.parquet")))
    inside = detected.filter(pl.col("r_um").is_between(edges_um[0], edges_um[split], closed="left"))
    assert small["n_detected"] == [inside.filter(pl.col("frame") == frame).height for frame in frames]


def test_trajectories_of_a_range_are_counted_by_reason(shared_house: House, run: Json) -> None:
    address = f"runs/{run['id']}/quality"
    found = shared_house.ok(shared_house.api.get(address, params={"from_s": -1.0}))["trajectories"]
    rejected = run["summary"]["n_rejected_trajectories"]
    assert found == {"kept": run["summary"]["n_trajectories"], **rejected}
    none = shared_house.ok(shared_house.api.get(address, params={"from_s": 1e9}))
    assert set(none["trajectories"].values()) == {0}


def test_quality_that_was_counted_over_all_radii_says_so(shared_house: House, run: Json) -> None:
    """A run of an earlier version: there is no file of radii."""
    with shared_house.context.sessions.begin() as session:
        prefix = session.scalars(
            select(Product.prefix)
            .join(Shard, Shard.product_id == Product.id)
            .where(Shard.run_id == UUID(run["id"]), Shard.task == "track")
        ).one()
    key = prefix + QUALITY_BY_RADIUS_FILE
    kept = shared_house.context.store.read(key)
    shared_house.context.store.remove(key)
    try:
        found = shared_house.ok(
            shared_house.api.get(f"runs/{run['id']}/quality", params={"radius_min_um": run_radius(run)})
        )
    finally:
        shared_house.context.store.put(key, kept)
    every = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/quality"))
    assert not found["is_of_radii"]
    assert found["n_tracked"] == every["n_tracked"]


def run_radius(run: Json) -> float:
    """A radius that halves the range."""
    detection = run["parameters"]["detection"]
    return float(np.sqrt(detection["radius_min_um"] * detection["radius_max_um"]))
