"""Previews: what a run with the same parameters would find, quickly, and a problem instead of silence."""

import base64
import json
import time
from typing import Any

import cv2
import numpy as np
import pytest

from backend.platform.previews import PreviewRequest, Region
from tests.house import House, Json
from worker.preview import answer


@pytest.fixture(scope="module")
def experiment(shared_house: House) -> Json:
    return shared_house.ready()


def _ask(house: House, experiment: Json, kind: str = "droplets", **about: Any) -> Json:
    key = f"experiments/{experiment['id']}/previews/test.json"
    request = {"kind": kind, "experiment_id": experiment["id"], "answer_key": key, "asked_at_s": time.time()}
    answer(house.context, PreviewRequest.model_validate(request | about))
    found: Json = json.loads(house.context.store.read(key))
    house.context.store.remove(key)
    return found


def test_a_preview_finds_what_a_run_finds(shared_house: House, experiment: Json) -> None:
    run = shared_house.start(experiment)
    shared_house.work()
    detected = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/1/droplets"))
    found = _ask(shared_house, experiment, frame=1, parameters=run["parameters"])["found"]
    assert np.allclose(found["x_px"], detected["x_px"])
    assert np.allclose(found["r_px"], detected["r_px"])
    assert len(found["rejected"]["x_px"]) == len(found["rejected"]["reason"])


def test_a_region_holds_only_what_lies_in_it_and_is_cut_to_the_frame(shared_house: House, experiment: Json) -> None:
    region = Region(x_px=-20, y_px=10, width_px=100, height_px=5000)
    found = _ask(shared_house, experiment, region=region, is_picture_wanted=True)["found"]
    assert found["region"]["x_px"] == 0
    assert found["region"]["width_px"] == 80
    assert all(0 <= x < 80 for x in found["x_px"] + found["rejected"]["x_px"])
    assert found["prepared_jpeg"]


def test_droplets_are_followed_as_tracking_does(shared_house: House, experiment: Json) -> None:
    found = _ask(shared_house, experiment, kind="links", frame=0)["found"]
    followed = [
        np.hypot(x - px, y - py)
        for x, y, px, py in zip(
            found["next_x_px"], found["next_y_px"], found["predicted_x_px"], found["predicted_y_px"], strict=True
        )
        if x is not None
    ]
    assert len(followed) > len(found["x_px"]) / 2
    assert np.median(followed) < 3


def test_what_is_measured_on_the_frames_is_proposed(shared_house: House, experiment: Json) -> None:
    found = _ask(shared_house, experiment, kind="suggestions")["found"]
    assert found["frames"]
    assert {measured["name"] for measured in found["measurements"]}
    assert all(one["field"].split(".")[0] in ("detection", "tracking", "flow") for one in found["suggestions"])


@pytest.mark.parametrize(
    ("about", "field"),
    [
        ({"region": {"x_px": 9000, "y_px": 0, "width_px": 5, "height_px": 5}}, "region"),
        ({"kind": "links", "frame": 5}, "frame"),
        ({"parameters": {"detection": {"radius_min_um": -1}}}, "detection.radius_min_um"),
    ],
)
def test_a_problem_is_answered_with_its_field(shared_house: House, experiment: Json, about: Json, field: str) -> None:
    problem = _ask(shared_house, experiment, **about)["problem"]
    assert [found["field"] for found in problem["errors"]] == [field]


def test_nobody_waits_for_an_old_request(shared_house: House, experiment: Json) -> None:
    with pytest.raises(FileNotFoundError):
        _ask(shared_house, experiment, asked_at_s=time.time() - 3600)
    late = shared_house.api.post(f"experiments/{experiment['id']}/previews", json={"frame": 99})
    assert (late.status_code, late.json()["code"]) == (404, "not_found.frame")


def test_a_frame_of_a_run_is_looked_at_as_the_run_was_told(shared_house: House, experiment: Json) -> None:
    told = experiment["experiment"] | {"pixel_size_um": experiment["experiment"]["pixel_size_um"] / 2}
    as_it_is = _ask(shared_house, experiment, frame=1)["found"]
    as_told = _ask(shared_house, experiment, frame=1, document=told)["found"]
    assert len(as_told["x_px"]) < len(as_it_is["x_px"])  # the smallest radius is twice as many pixels


def test_a_frame_is_prepared_as_detection_sees_it(shared_house: House, experiment: Json) -> None:
    found = _ask(shared_house, experiment, kind="prepared", frame=1)["found"]
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(found["jpeg"]), np.uint8), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    assert picture.shape == (experiment["stack"]["rows"], experiment["stack"]["columns"])
    looked_at = _ask(shared_house, experiment, frame=1, is_picture_wanted=True)["found"]
    assert looked_at["prepared_jpeg"] == found["jpeg"]
