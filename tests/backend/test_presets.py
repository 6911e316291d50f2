"""Presets: parameters that a group finds again under a name."""

import pytest

from backend.models import Right
from backend.presets.service import MOST
from tests.house import House, Json
from tests.lab import Lab

SMALL: Json = {"detection": {"radius_min_um": 2.5}}


def _group(house: House) -> str:
    return str(house.ok(house.api.get("session"))["groups"][0]["id"])


def _save(house: House, group: str, name: str, parameters: Json | None = None, status: int = 201) -> Json:
    body = {"name": name, "parameters": SMALL if parameters is None else parameters}
    return house.ok(house.api.post(f"groups/{group}/presets", json=body), status)


def test_a_preset_holds_every_parameter_and_is_found_by_name(house: House) -> None:
    group = _group(house)
    for name in ("wide", "  Small ones "):
        _save(house, group, name)
    items = house.ok(house.api.get(f"groups/{group}/presets"))["items"]
    assert [item["name"] for item in items] == ["Small ones", "wide"]
    assert items[0]["parameters"]["detection"]["radius_min_um"] == 2.5
    assert "tracking" in items[0]["parameters"]
    run = house.start(house.ready(), items[0]["parameters"])
    assert run["parameters"] == items[0]["parameters"]


def test_a_preset_is_replaced_renamed_and_deleted(house: House) -> None:
    group = _group(house)
    first, second = _save(house, group, "first"), _save(house, group, "second")
    address = f"groups/{group}/presets/{first['id']}"
    changed = {"name": "other", "parameters": {"detection": {"radius_min_um": 6}}}
    assert house.ok(house.api.put(address, json=changed))["parameters"]["detection"]["radius_min_um"] == 6
    taken = house.ok(house.api.put(address, json=changed | {"name": "second"}), 409)
    assert taken["code"] == "conflict.preset_name"
    assert house.api.delete(f"groups/{group}/presets/{second['id']}").status_code == 204
    assert house.ok(house.api.put(address, json=changed | {"name": "second"}))["name"] == "second"
    assert house.ok(house.api.delete(f"groups/{group}/presets/{second['id']}"), 404)["code"] == "not_found.preset"


@pytest.mark.parametrize(
    ("name", "parameters", "field"),
    [
        ("", {}, "name"),
        ("two\nlines", {}, "name"),
        ("n" * 101, {}, "name"),
        ("wrong", {"detection": {"radius_min_um": -1}}, "detection.radius_min_um"),
        ("unknown", {"detector": {}}, "detector"),
    ],
)
def test_what_could_not_be_used_is_refused(house: House, name: str, parameters: Json, field: str) -> None:
    problem = _save(house, _group(house), name, parameters, 422)
    assert [error["field"] for error in problem["errors"]] == [field]


def test_a_name_is_taken_once_and_a_group_has_only_so_many(house: House) -> None:
    group = _group(house)
    for number in range(MOST):
        _save(house, group, f"number {number}", {})
    assert _save(house, group, "number 3", status=409)["code"] == "conflict.preset_name"
    assert _save(house, group, "one more", status=409)["code"] == "conflict.presets_full"


def test_a_group_keeps_its_presets_to_itself_and_says_who_saved_them(lab: Lab) -> None:
    foams, grains = lab.group("Foams"), lab.group("Grains")
    ada = lab.as_(lab.person("Ada", {foams: Right.EDIT}))
    grace = lab.as_(lab.person("Grace", {grains: Right.MANAGE}))
    made = _save(ada, str(foams), "of foams")
    assert made["saved_by"] == "Ada"
    _save(grace, str(grains), "of foams")
    address = f"groups/{grains}/presets/{made['id']}"
    assert grace.ok(grace.api.delete(address), 404)["code"] == "not_found.preset"
    assert grace.ok(grace.api.get(f"groups/{foams}/presets"), 404)["code"] == "not_found.group"
