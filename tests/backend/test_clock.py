"""The clock of a film: when each frame was taken, and how warm it was."""

import pytest

from tests.films import N_FRAMES, Upload, film
from tests.house import House

LOG = b"time_s,temperature_c\n-10,30.0\n0,30.0\n5,30.5\n100,40.0\n"


def test_each_frame_has_its_time_and_its_temperature(house: House) -> None:
    made = house.ready([*film(), Upload("log.csv", LOG, role="temperature_log")], temperature_log="log.csv")
    clock = house.ok(house.api.get(f"experiments/{made['id']}/clock"))
    assert clock["time_s"] == [float(index) for index in range(N_FRAMES)]
    assert clock["temperature_c"] == pytest.approx([30 + 0.1 * index for index in range(N_FRAMES)])


def test_a_corrected_interval_is_the_clock_of_from_then_on(house: House) -> None:
    made = house.ready()
    assert house.ok(house.api.get(f"experiments/{made['id']}/clock"))["temperature_c"] is None
    corrected = {"experiment": made["experiment"] | {"frame_interval_s": 0.5}}
    house.ok(house.api.patch(f"experiments/{made['id']}", json=corrected))
    assert house.ok(house.api.get(f"experiments/{made['id']}/clock"))["time_s"][-1] == (N_FRAMES - 1) / 2


def test_without_frames_there_is_no_clock(house: House) -> None:
    made = house.experiment()
    assert house.ok(house.api.get(f"experiments/{made['id']}/clock"), 409)["code"].startswith("conflict")
