"""Deletion in two steps: thrown away is out of sight and can be brought back; emptied is gone."""

from datetime import timedelta
from typing import Any

import pytest
from sqlalchemy import func, text, update

from backend.models import Experiment, Right, Run, Stack
from tests.films import EXPERIMENT, film
from tests.house import House, Json
from tests.lab import Lab
from worker.retention import retain


def _analysed(house: House) -> tuple[Json, Json]:
    experiment = house.ready(film())
    run = house.start(experiment)
    house.work()
    return house.again(experiment), house.again(run)


def _trash(house: House) -> Json:
    return house.ok(house.api.get("trash"))


def _kept_bytes(house: House, part: str = "") -> int:
    return sum((house.objects / key).stat().st_size for key in house.kept_objects() if part in key)


def test_an_experiment_goes_to_the_trash_with_its_bytes_and_comes_back_whole(house: House) -> None:
    experiment, run = _analysed(house)
    before = house.kept_objects()
    assert house.api.delete(f"experiments/{experiment['id']}").status_code == 204
    for path in (f"experiments/{experiment['id']}", f"runs/{run['id']}", f"runs/{run['id']}/files"):
        assert house.api.get(path).status_code == 404
    assert house.ok(house.api.get("experiments"))["items"] == house.ok(house.api.get("runs"))["items"] == []
    (item,) = _trash(house)["items"]
    assert (item["kind"], item["size_bytes"]) == ("experiment", _kept_bytes(house))
    assert house.kept_objects() == before
    assert house.api.post(f"trash/experiments/{experiment['id']}/restore").status_code == 204
    assert house.again(experiment) | {"updated_at": experiment["updated_at"]} == experiment
    assert house.again(run) == run
    assert _trash(house) == {"items": [], "size_bytes": 0}


def test_a_run_goes_and_comes_back_and_emptying_frees_the_bytes_that_were_shown(house: House) -> None:
    experiment, run = _analysed(house)
    assert house.api.delete(f"runs/{run['id']}").status_code == 204
    assert house.again(experiment)["n_runs"] == 0
    assert house.api.post(f"trash/runs/{run['id']}/restore").status_code == 204
    assert house.again(run)["summary"] == run["summary"]
    house.api.delete(f"runs/{run['id']}")
    before = _kept_bytes(house)
    emptied = house.ok(house.api.delete("trash"))
    assert emptied["n_items"] == 1
    assert before - _kept_bytes(house) == emptied["size_bytes"] > 0
    assert house.api.post(f"trash/runs/{run['id']}/restore").status_code == 404
    assert house.again(experiment)["stack"]["state"] == "ready"


def test_what_a_run_shares_with_another_is_no_room_that_it_frees(house: House) -> None:
    experiment, first = _analysed(house)
    second = house.start(experiment)
    house.work()
    house.api.delete(f"runs/{first['id']}")
    (item,) = _trash(house)["items"]
    emptied = house.ok(house.api.delete("trash"))
    assert (item["size_bytes"], emptied["n_items"]) == (emptied["size_bytes"], 1)
    assert house.again(second)["state"] == "completed"
    assert house.api.get(f"runs/{second['id']}/files/trajectories.parquet").status_code == 200


def test_raw_frames_can_go_while_results_stay(house: House) -> None:
    experiment, run = _analysed(house)
    gone = house.ok(house.api.delete(f"experiments/{experiment['id']}/frames"))
    assert gone["stack"]["state"] == "expired"
    picture = f"experiments/{experiment['id']}/frames/0.jpg"
    for answer in (house.api.get(picture), house.api.post(f"experiments/{experiment['id']}/runs", json={})):
        assert (answer.status_code, answer.json()["code"]) == (409, "conflict.frames_expired")
    assert house.api.get(f"runs/{run['id']}/files/trajectories.parquet").status_code == 200
    back = house.ok(house.api.post(f"trash/frames/{experiment['id']}/restore"))
    assert back["stack"] == experiment["stack"]
    assert house.api.get(picture).status_code == 200
    house.api.delete(f"experiments/{experiment['id']}/frames")
    (item,) = _trash(house)["items"]
    assert item["size_bytes"] == _kept_bytes(house, "/files/") > 0
    assert house.api.delete(f"trash/frames/{experiment['id']}").status_code == 204
    assert _kept_bytes(house, "/files/") == 0
    assert house.again(experiment)["stack"]["state"] == "expired"
    for name in ("trajectories.parquet", "droplets.parquet"):
        assert house.api.get(f"runs/{run['id']}/files/{name}").status_code == 200
    assert house.ok(house.api.get(f"runs/{run['id']}/figures/moments"))["data"]
    assert house.api.post(f"trash/frames/{experiment['id']}/restore").json()["code"] == "conflict.not_in_trash"


def test_frames_that_a_run_needs_stay(house: House) -> None:
    experiment = house.ready(film())
    house.start(experiment)
    assert house.api.delete(f"experiments/{experiment['id']}/frames").status_code == 409


def _age(house: House, kind: Any, days: float) -> None:
    with house.context.sessions.begin() as session:
        session.execute(update(kind).values(trashed_at=func.now() - timedelta(days=days)))


@pytest.mark.parametrize("kind", [Experiment, Run, Stack])
def test_what_lies_in_the_trash_for_long_is_removed(house: House, kind: Any) -> None:
    experiment, run = _analysed(house)
    paths = {Experiment: f"experiments/{experiment['id']}", Run: f"runs/{run['id']}",
             Stack: f"experiments/{experiment['id']}/frames"}  # fmt: skip
    assert house.api.delete(paths[kind]).status_code in (200, 204)
    _age(house, kind, days=29)
    retain(house.context)
    assert len(_trash(house)["items"]) == 1
    _age(house, kind, days=31)
    retain(house.context)
    assert _trash(house)["items"] == []
    left = house.kept_objects()
    assert (left == []) == (kind is Experiment)
    assert any("/files/" in key for key in left) == (kind is Run)


def test_frames_expire_some_time_after_their_last_completed_run(house: House) -> None:
    experiment, _ = _analysed(house)
    not_analysed = house.ready(film())
    context = house.context
    settings = context.settings.model_copy(update={"frames_expire_s": 86_400.0})
    object.__setattr__(context, "settings", settings)
    try:
        retain(context)
        assert house.again(experiment)["stack"]["state"] == "ready"
        with context.sessions.begin() as session:
            session.execute(text("UPDATE run SET finished_at = now() - interval '2 days'"))
        retain(context)
    finally:
        object.__setattr__(context, "settings", settings.model_copy(update={"frames_expire_s": None}))
    assert house.again(experiment)["stack"]["state"] == "expired"
    assert house.again(not_analysed)["stack"]["state"] == "ready"
    (item,) = _trash(house)["items"]
    assert (item["kind"], item["trashed_by"]) == ("frames", None)


def test_the_trash_of_others_is_theirs(lab: Lab) -> None:
    group = lab.group("Foams")
    ada, viewer = (
        lab.as_(lab.person(name, {group: right})) for name, right in (("Ada", Right.EDIT), ("Vi", Right.VIEW))
    )
    stranger = lab.as_(lab.person("Bob", {lab.group("Others"): Right.EDIT}))
    body = {"experiment": EXPERIMENT, "group_id": str(group)}
    experiment = ada.ok(ada.api.post("experiments", json=body), 201)
    assert ada.api.delete(f"experiments/{experiment['id']}").status_code == 204
    path = f"trash/experiments/{experiment['id']}"
    assert [item["trashed_by"] for item in _trash(viewer)["items"]] == ["Ada"]
    assert _trash(stranger)["items"] == []
    assert (viewer.api.delete(path).status_code, stranger.api.delete(path).status_code) == (403, 404)
    assert viewer.ok(viewer.api.delete("trash"))["n_items"] == stranger.ok(stranger.api.delete("trash"))["n_items"] == 0
    assert ada.api.post(f"{path}/restore").status_code == 204
    assert ada.api.delete(path).json()["code"] == "conflict.not_in_trash"
