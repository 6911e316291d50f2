"""Experiments and their documents."""

import json
from typing import Any

import pytest

from tests.films import EXPERIMENT, Upload, film, frame, png
from tests.house import House


def test_a_new_experiment_is_answered_with_its_document_and_an_empty_stack(house: House) -> None:
    made = house.experiment(notes="α Θ 水")
    assert made["experiment"]["notes"] == "α Θ 水"
    assert made["experiment"]["up"] == [0.0, -1.0]
    assert made["stack"]["state"] == "empty"
    assert made["n_runs"] == 0
    assert made["latest_run"] is None
    assert house.again(made) == made


@pytest.mark.parametrize(
    ("changes", "code", "field"),
    [
        ({"pixel_size_um": 0}, "experiment.invalid", "pixel_size_um"),
        ({"frame_interval_s": -1}, "experiment.invalid", "frame_interval_s"),
        ({"frame_interval_s": None}, "experiment.invalid", "frame_interval_s"),
        ({"material": {"delta_density_kg_m3": 1.0}}, "experiment.invalid", "material.viscosity_pa_s"),
        ({"material": "unobtainium"}, "experiment.material_unknown", "material"),
        ({"droplets": "blue"}, "experiment.invalid", "droplets"),
        ({"surprise": 1}, "experiment.invalid", "surprise"),
        ({"notes": "a\0b"}, "experiment.invalid", "notes"),
        ({"tags": ["\ud800"]}, "experiment.invalid", "tags.0"),
    ],
)
def test_a_wrong_document_is_refused_naming_the_field(
    house: House, changes: dict[str, Any], code: str, field: str
) -> None:
    document = EXPERIMENT | changes
    # By hand, for a client of good manners would not send half a character.
    answer = house.api.post(
        "experiments", content=json.dumps({"experiment": document}), headers={"Content-Type": "application/json"}
    )
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["code"] == code
    assert field in [found["field"] for found in answer.json()["errors"]]
    assert house.ok(house.api.get("experiments"))["items"] == []


def test_experiments_are_listed_newest_first_page_by_page(house: House) -> None:
    names = [house.experiment(name=f"film {number}")["experiment"]["name"] for number in range(5)]
    seen, cursor = [], None
    while True:
        page = house.ok(house.api.get("experiments", params={"limit": 2} | ({"cursor": cursor} if cursor else {})))
        seen += [item["experiment"]["name"] for item in page["items"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert seen == names[::-1]


@pytest.mark.parametrize("cursor", ["x", "WzFd", "WyJhIiwgImIiXQ==", "\0", "W10="])
def test_a_cursor_that_is_none_is_refused(house: House, cursor: str) -> None:
    answer = house.api.get("experiments", params={"cursor": cursor})
    assert answer.status_code == 422
    assert answer.json()["code"] == "request.invalid"


def test_a_document_can_be_replaced_and_the_times_of_its_frames_follow(house: House) -> None:
    ready = house.ready()
    changed = house.ok(
        house.api.patch(
            f"experiments/{ready['id']}", json={"experiment": EXPERIMENT | {"name": "six", "frame_interval_s": 2.0}}
        )
    )
    assert changed["experiment"]["name"] == "six"
    assert changed["stack"]["duration_s"] == 10.0


def test_what_frames_were_read_with_cannot_be_changed(house: House) -> None:
    ready = house.ready()
    answer = house.api.patch(f"experiments/{ready['id']}", json={"experiment": EXPERIMENT | {"grey_from": "red"}})
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.describes_files"
    assert "grey_from" in answer.json()["detail"]


@pytest.mark.parametrize("method", ["PATCH", "DELETE"])
def test_nothing_is_changed_or_deleted_under_a_run(house: House, method: str) -> None:
    ready = house.ready()
    house.start(ready)
    body = {"json": {"experiment": EXPERIMENT}} if method == "PATCH" else {}
    answer = house.api.request(method, f"experiments/{ready['id']}", **body)
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.run_active"


def test_a_document_is_not_changed_while_frames_are_read_with_it(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film())
    house.api.post(f"experiments/{experiment['id']}/stack")
    answer = house.api.patch(f"experiments/{experiment['id']}", json={"experiment": EXPERIMENT})
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.stack_indexing"


def test_a_deleted_experiment_leaves_no_object(house: House) -> None:
    other = house.experiment()
    house.upload(other, Upload("kept.png", png(frame(0))))
    kept = house.kept_objects()
    ready = house.ready()
    house.start(ready)
    house.work()
    assert len(house.kept_objects()) > len(kept)
    assert house.api.delete(f"experiments/{ready['id']}", params={"forever": True}).status_code == 204
    assert house.api.get(f"experiments/{ready['id']}").status_code == 404
    assert house.kept_objects() == kept


def test_the_list_shows_the_latest_run_with_its_progress(house: House) -> None:
    ready = house.ready()
    house.start(ready)
    house.work()
    second = house.start(ready)
    (item,) = house.ok(house.api.get("experiments"))["items"]
    assert item["n_runs"] == 2
    assert item["latest_run"]["id"] == second["id"]
    assert [stage["state"] for stage in item["latest_run"]["stages"]] == ["waiting"] * 3
    house.work()
    assert house.again(ready)["latest_run"]["n_droplets"] == house.again(second)["summary"]["detected"]["n_droplets"]
