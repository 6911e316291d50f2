"""Exports and the report of a run: the same as the commands make, sent while they are made."""

import io
import json
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import h5py
import polars as pl
import pytest
from sqlalchemy import select

from backend.models import Product, Shard
from backend.results import exporting
from dropflow.exports.kinds import Kind
from tests.house import House, Json


@pytest.fixture(scope="module")
def run(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


def test_every_form_is_listed_and_there(shared_house: House, run: Json) -> None:
    items = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/exports"))["items"]
    assert [item["kind"] for item in items] == list(Kind)
    assert all(item["is_available"] for item in items)


@pytest.mark.parametrize("kind", list(Kind))
def test_an_export_is_what_it_says(shared_house: House, run: Json, kind: Kind) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/exports/{kind}", timeout=60)
    assert answer.status_code == 200, answer.text
    assert f"run-{run['number']}-{kind}" in answer.headers["content-disposition"] or kind is Kind.ZARR
    content = io.BytesIO(answer.content)
    n_rows = run["summary"]["tracked"]["n_droplets"]
    match kind:
        case Kind.CSV | Kind.TRACKPY | Kind.NAPARI:
            assert len(pl.read_csv(content, comment_prefix="#")) == n_rows
        case Kind.PARQUET:
            assert len(pl.read_parquet(content)) == n_rows
        case Kind.TRACKMATE:
            assert len(list(ET.parse(content).iter("Spot"))) == n_rows  # noqa: S314 - made by this test
        case Kind.ZARR:
            assert zipfile.ZipFile(content).testzip() is None
        case Kind.HDF5 | Kind.NETCDF:
            with h5py.File(content) as file:
                assert json.loads(file.attrs["dropflow"])["n_frames"] == run["summary"]["n_frames"]
    assert not list(shared_house.context.settings.work_dir.glob("export_*"))


def test_no_more_processes_than_there_may_be(shared_house: House, run: Json) -> None:
    taken = [exporting._free.acquire(blocking=False) for _ in range(exporting.MOST_AT_ONCE)]
    assert all(taken)
    try:
        answer = shared_house.api.get(f"runs/{run['id']}/exports/csv")
        assert (answer.status_code, answer.json()["code"]) == (503, "service.busy")
    finally:
        for _ in taken:
            exporting._free.release()


def test_a_reader_who_leaves_takes_the_process_along(shared_house: House, run: Json, tmp_path: Path) -> None:
    with shared_house.context.sessions() as session:
        made = select(Product).join(Shard, Shard.product_id == Product.id).where(Shard.run_id == run["id"])
        tracked, analysed = (session.scalar(made.where(Shard.task == task)) for task in ("track", "analyse"))
    assert tracked is not None
    assert analysed is not None
    content = exporting.export(shared_house.context.store, tracked, analysed, Kind.CSV, tmp_path)
    assert next(content)
    content.close()
    assert not list(tmp_path.iterdir())
    free = [exporting._free.acquire(blocking=False) for _ in range(exporting.MOST_AT_ONCE)]
    for _ in free:
        exporting._free.release()
    assert all(free)


def test_the_report_is_a_page_that_asks_nobody(shared_house: House, run: Json) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/report.html")
    assert answer.headers["content-type"].startswith("text/html")
    assert "default-src 'none'" in answer.headers["content-security-policy"]
    assert answer.text.startswith("<!doctype html>")


@pytest.mark.parametrize("path", ["report.html", "exports/csv", "exports/zarr"])
def test_before_the_analysis_there_is_neither(house: House, path: str) -> None:
    run = house.start(house.ready())
    answer = house.api.get(f"runs/{run['id']}/{path}")
    assert (answer.status_code, answer.json()["code"]) == (404, "results.not_yet")
    assert not house.ok(house.api.get(f"runs/{run['id']}/exports"))["items"][0]["is_available"]
