"""Planning: the same numbers as the library's, and ramps that can be downloaded."""

import pytest

from dropflow.experiment import Phase
from dropflow.physics.material import resolve_at
from dropflow.physics.material_files import find_material, known_names
from tests.house import House

MIXTURE = "water-isobutoxyethanol-illustrative"


def test_every_material_is_listed_and_says_whether_its_numbers_were_measured(shared_house: House) -> None:
    items = shared_house.ok(shared_house.api.get("materials"))["items"]
    assert [item["name"] for item in items] == list(known_names())
    mixture = next(item for item in items if item["name"] == MIXTURE)
    assert mixture["is_mixture"]
    assert mixture["is_illustrative"]
    assert mixture["range_c"][0] < 30 < mixture["range_c"][1]


def test_droplets_move_as_stokes_law_says_in_both_phases(shared_house: House) -> None:
    found = shared_house.ok(shared_house.api.get(f"materials/{MIXTURE}", params={"temperature_c": 40}))
    by_phase = {entry["phase"]: entry for entry in found["sedimentation"]}
    for phase in Phase:
        known = resolve_at(find_material(MIXTURE), temperature_c=40, phase=phase)
        assert by_phase[phase]["viscosity_pa_s"] == pytest.approx(known.viscosity_pa_s)
    # Light droplets rise in the bottom phase, heavy ones sink in the top phase.
    assert min(by_phase["bottom"]["speed_um_s"]) > 0 > max(by_phase["top"]["speed_um_s"])
    assert all(entry["source"] for entry in found["properties"])


def test_a_ramp_can_be_asked_for_by_its_driving_or_its_duration(shared_house: House) -> None:
    address = f"materials/{MIXTURE}/ramp"
    by_driving = shared_house.ok(shared_house.api.get(address, params={"driving_per_s": 1.05e-5}))
    by_duration = shared_house.ok(shared_house.api.get(address, params={"duration_s": by_driving["duration_s"]}))
    assert by_duration["driving_per_s"] == pytest.approx(1.05e-5, rel=1e-6)
    assert by_driving["figure"]["data"]


def test_the_set_points_are_one_a_second_with_the_protocol_before_them(shared_house: House) -> None:
    asked = {"duration_s": 60, "has_protocol": True, "start_c": 30, "end_c": 31}
    answer = shared_house.api.get(f"materials/{MIXTURE}/ramp.csv", params=asked)
    assert answer.headers["content-disposition"] == f'attachment; filename="ramp-{MIXTURE}.csv"'
    lines = answer.text.splitlines()
    assert lines[0] == "time_s,temperature_c,stage"
    assert len(lines) == 1 + 3600 + 4 * 3600 + 61
    assert lines[-1] == f"{5 * 3600 + 60},31.0000,ramp"


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("materials/syrup", 404, "not_found.material"),
        (f"materials/{MIXTURE}/ramp", 422, "parameters.invalid"),
        (f"materials/{MIXTURE}/ramp?driving_per_s=1e-5&duration_s=60", 422, "parameters.invalid"),
        (f"materials/{MIXTURE}/ramp?driving_per_s=0", 422, "request.invalid"),
        (f"materials/{MIXTURE}/ramp?duration_s=60&start_c=40&end_c=30", 422, "parameters.invalid"),
        (f"materials/{MIXTURE}/ramp.csv?driving_per_s=1e-9", 422, "parameters.invalid"),
        ("materials/polystyrene-in-water-25c/phase_diagram", 422, "material.property_missing"),
    ],
)
def test_what_cannot_be_planned_is_said(shared_house: House, path: str, status: int, code: str) -> None:
    answer = shared_house.api.get(path)
    assert (answer.status_code, answer.json()["code"]) == (status, code)
