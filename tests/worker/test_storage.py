"""Every byte in the object store belongs to a row, or goes; what somebody is writing stays."""

import os
import time
from datetime import timedelta

import pytest
from sqlalchemy import func, update

from backend.models import Upload as Row
from tests.films import film
from tests.house import House, Json
from tests.sending import content_of, offset, patch, plan, send_all
from worker.context import Context
from worker.storage import expire_uploads, sweep_orphans


@pytest.fixture
def begun(house: House) -> Json:
    """An upload of which half is here, beside a finished run of another film."""
    run = house.start(house.ready())
    house.work()
    assert house.again(run)["state"] == "completed"
    experiment = house.experiment()
    send_all(house, experiment, film(2))
    (upload,) = plan(house, experiment, film(4))["uploads"]
    assert patch(house, upload["location"], 0, content_of(upload, film(4))[:1000]).status_code == 204
    return upload


def test_a_sweep_removes_what_no_row_speaks_of_and_nothing_else(house: House, begun: Json) -> None:
    kept = house.kept_objects()
    some = "experiments/00000000-0000-4000-8000-00000000dead"
    orphans = [
        f"{some}/files/00000000-0000-4000-8000-00000000beef",
        f"{some}/files/00000000-0000-4000-8000-00000000beef/000000000000000-1",
        f"{some}/products/00000000-0000-4000-8000-00000000beef/3/droplets.parquet",
    ]
    house.context.store.put(orphans[0], b"lost")
    house.context.store.put(orphans[2], b"lost")
    (house.objects / "experiments" / "half#1").write_bytes(b"written when the power went")
    assert sweep_orphans(house.context) == 0
    _make_old(house)
    assert sweep_orphans(house.context) == 2
    assert house.kept_objects() == kept
    assert offset(house, begun["location"]) == 1000


def test_a_sweep_leaves_what_a_worker_is_making(house: House) -> None:
    experiment = house.experiment()
    send_all(house, experiment, film())
    house.ok(house.api.post(f"experiments/{experiment['id']}/stack"), 202)
    (shard_id,) = house.waiting()
    key = f"experiments/{experiment['id']}/products/{shard_id}/1/index.json"
    house.context.store.put(key, b"{}")
    _make_old(house)
    assert sweep_orphans(house.context) == 0
    assert key in house.kept_objects()


def test_an_upload_that_nobody_continues_expires_with_its_bytes(house: House, begun: Json) -> None:
    n_before = len(house.kept_objects())
    expire_uploads(house.context)
    assert len(house.kept_objects()) == n_before
    _expire(house.context, held=True)
    expire_uploads(house.context)
    assert offset(house, begun["location"]) == 1000
    _expire(house.context, held=False)
    expire_uploads(house.context)
    assert house.api.get(begun["location"]).status_code == 404
    assert len(house.kept_objects()) == n_before - 1
    experiment = {"id": begun["location"].split("/")[1]}
    assert house.again(experiment)["stack"]["n_files"] == 2


def _expire(context: Context, *, held: bool) -> None:
    away = timedelta(hours=1 if held else -1)
    with context.sessions.begin() as session:
        session.execute(update(Row).values(expires_at=func.now() - timedelta(hours=1), held_until=func.now() + away))


def _make_old(house: House) -> None:
    long_ago = time.time() - 2 * house.context.settings.orphan_grace_s
    for path in house.objects.rglob("*"):
        if path.is_file():
            os.utime(path, (long_ago, long_ago))
