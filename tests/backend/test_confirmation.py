"""A person confirms order, times and scale: the server keeps who, when and what, until any of it changes."""

from typing import Any

import httpx

from backend.models import Right
from tests.films import EXPERIMENT, film
from tests.house import House, Json
from tests.lab import Lab


def _facts(experiment: Json) -> Json:
    stack = experiment["stack"]
    about = {name: stack[name] for name in ("checksum", "n_frames", "duration_s")}
    return {**about, "pixel_size_um": experiment["experiment"]["pixel_size_um"]}


def _confirm(house: House, experiment: Json, **changes: Any) -> httpx.Response:
    return house.api.put(f"experiments/{experiment['id']}/confirmation", json={**_facts(experiment), **changes})


def test_who_confirmed_and_when_is_kept_until_scale_or_times_change(lab: Lab) -> None:
    group = lab.group("Foams")
    house = lab.as_(lab.person("Ada", {group: Right.EDIT}))
    experiment = house.ready(film())
    assert experiment["stack"]["confirmation"] is None
    confirmed = house.ok(_confirm(house, experiment))["stack"]["confirmation"]
    assert confirmed["by"] == "Ada"
    assert house.again(experiment)["stack"]["confirmation"] == confirmed
    for change in ({"pixel_size_um": 2.0}, {"frame_interval_s": 3.0}):
        path = f"experiments/{experiment['id']}"
        changed = house.ok(house.api.patch(path, json={"experiment": {**EXPERIMENT, **change}}))
        assert changed["stack"]["confirmation"] is None
        back = house.ok(house.api.patch(path, json={"experiment": {**EXPERIMENT, "notes": "as it was"}}))
        assert back["stack"]["confirmation"] == confirmed


def test_what_is_not_there_cannot_be_confirmed(house: House) -> None:
    experiment = house.ready(film())
    for wrong in ({"n_frames": 5}, {"pixel_size_um": 2.0}, {"checksum": "0"}, {"duration_s": 1.0}):
        answer = _confirm(house, experiment, **wrong)
        assert (answer.status_code, answer.json()["code"]) == (409, "conflict.changed_meanwhile")
    empty = house.experiment()
    answer = house.api.put(f"experiments/{empty['id']}/confirmation", json=_facts(experiment))
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.stack_not_ready")
