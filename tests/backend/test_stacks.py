"""From uploaded files to a stack that is ready, or rejected without a trace."""

import io
import zipfile

import cv2
import numpy as np
import pytest

from tests.films import N_FRAMES, Upload, film, frame, png, tiff
from tests.house import House

GOOD = tiff(frame(0))


def _zip(*files: Upload) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for file in files:
            archive.writestr(file.name, file.content)
    return packed.getvalue()


def _coloured() -> bytes:
    return png(np.dstack([frame(0)] * 3))


@pytest.mark.parametrize(
    "files",
    [
        film(),
        [Upload("film.tif", tiff(*(frame(index) for index in range(N_FRAMES))))],
        [Upload("film.zip", _zip(*film()))],
        [Upload(f"{index}.png", png(frame(index))) for index in range(N_FRAMES)],
    ],
    ids=["folder", "pages", "zip", "png"],
)
def test_a_stack_of_any_form_becomes_ready_with_what_was_found(house: House, files: list[Upload]) -> None:
    stack = house.ready(files)["stack"]
    found = {name: stack[name] for name in ("n_frames", "rows", "columns", "dtype", "duration_s", "problem")}
    assert found == {
        "n_frames": N_FRAMES,
        "rows": 160,
        "columns": 200,
        "dtype": "uint8",
        "duration_s": N_FRAMES - 1.0,
        "problem": None,
    }
    assert stack["n_files"] == len(files)


def test_while_frames_are_read_the_stack_says_so(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film())
    sealed = house.ok(house.api.post(f"experiments/{experiment['id']}/stack"), 202)
    assert sealed["stack"]["state"] == "indexing"
    assert sealed["stack"]["done_frames"] == 0
    again = house.api.post(f"experiments/{experiment['id']}/stack")
    assert again.status_code == 409
    assert again.json()["code"] == "conflict.stack_closed"


@pytest.mark.parametrize(
    ("files", "code", "file", "at"),
    [
        ([Upload("a.tif", GOOD), Upload("b.tif", GOOD[: len(GOOD) // 2])], "frames.truncated", "b.tif", 1),
        ([Upload("a.tif", GOOD), Upload("b.tif", tiff(frame(0)[:100]))], "frames.shape_mismatch", "b.tif", 1),
        ([Upload("a.png", _coloured())], "frames.colour", "a.png", None),
        ([Upload("a.zip", _zip(Upload("readme.txt", b"hello")))], "frames.empty", "a.zip", None),
        ([Upload("a.zip", b"PK\x03\x04" + bytes(100))], "frames.truncated", "a.zip", None),
        ([Upload("1/a.tif", GOOD), Upload("2/a.tif", GOOD)], "frames.several_folders", "the stack", None),
    ],
    ids=["truncated", "shape", "colour", "no images", "broken zip", "two folders"],
)
def test_a_stack_that_cannot_be_used_is_rejected_with_the_cause_and_leaves_nothing(
    house: House, files: list[Upload], code: str, file: str, at: int | None
) -> None:
    experiment = house.experiment()
    house.upload(experiment, *files)
    stack = house.seal(experiment)["stack"]
    assert stack["state"] == "rejected"
    assert (stack["problem"]["code"], stack["problem"]["file"], stack["problem"]["frame"]) == (code, file, at)
    assert (stack["n_files"], stack["size_bytes"], stack["n_frames"]) == (0, 0, None)
    assert house.kept_objects() == []


def test_after_a_rejection_other_files_can_be_uploaded(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, Upload("a.png", _coloured()))
    assert house.seal(experiment)["stack"]["state"] == "rejected"
    house.upload(experiment, *film())
    stack = house.seal(experiment)["stack"]
    assert (stack["state"], stack["problem"]) == ("ready", None)


def test_colour_frames_become_grey_where_the_experiment_says_how(house: House) -> None:
    stack = house.ready([Upload("a.png", _coloured())], grey_from="luminance")["stack"]
    assert (stack["n_frames"], stack["rows"]) == (1, 160)


def test_times_come_from_a_table_where_the_experiment_names_one(house: House) -> None:
    times = Upload("times.csv", b"time_s\n0\n1\n2.5\n4\n5\n9\n", "timestamps")
    ready = house.ready([*film(), times], frame_interval_s=None, timestamps="times.csv")
    assert ready["stack"]["duration_s"] == 9.0


def test_a_table_with_too_few_times_rejects_the_stack(house: House) -> None:
    experiment = house.experiment(frame_interval_s=None, timestamps="times.csv")
    house.upload(experiment, *film(), Upload("times.csv", b"time_s\n0\n1\n", "timestamps"))
    problem = house.seal(experiment)["stack"]["problem"]
    assert problem["code"] == "experiment.invalid"
    assert problem["errors"][0]["field"] == "timestamps"


def test_what_is_odd_about_a_stack_and_no_error_is_told(house: House) -> None:
    stack = house.ready([Upload(f"frame{number}.tif", tiff(frame(number))) for number in (0, 1, 3, 4)])["stack"]
    assert stack["n_frames"] == 4
    assert any("missing" in warning for warning in stack["warnings"])
    assert stack["duration_s"] == 4.0


def test_a_removed_stack_leaves_no_object_and_a_new_one_can_come(house: House) -> None:
    ready = house.ready()
    emptied = house.ok(house.api.delete(f"experiments/{ready['id']}/stack"))
    assert emptied["stack"]["state"] == "empty"
    assert emptied["stack"]["n_frames"] is None
    assert house.kept_objects() == []
    house.upload(ready, *film(3))
    assert house.seal(ready)["stack"]["n_frames"] == 3


def test_a_stack_can_be_removed_while_it_is_indexed(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film())
    house.api.post(f"experiments/{experiment['id']}/stack")
    assert len(house.waiting()) == 1
    assert house.ok(house.api.delete(f"experiments/{experiment['id']}/stack"))["stack"]["state"] == "empty"
    assert house.waiting() == []
    assert house.kept_objects() == []


def test_frames_that_runs_were_made_of_stay(house: House) -> None:
    ready = house.ready()
    house.start(ready)
    answer = house.api.delete(f"experiments/{ready['id']}/stack")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.runs_exist"


@pytest.mark.parametrize(("kind", "media_type"), [("webp", "image/webp"), ("jpg", "image/jpeg")])
def test_a_frame_is_a_stretched_picture_of_bounded_size(house: House, kind: str, media_type: str) -> None:
    ready = house.ready()
    answer = house.api.get(f"experiments/{ready['id']}/frames/2.{kind}", params={"max_side": 100})
    assert answer.headers["content-type"] == media_type
    picture = cv2.imdecode(np.frombuffer(answer.content, np.uint8), cv2.IMREAD_UNCHANGED)
    assert picture.shape[:2] == (80, 100)
    assert picture.min() < 20
    assert picture.max() > 235
    whole = house.api.get(f"experiments/{ready['id']}/frames/2.{kind}")
    shown = cv2.imdecode(np.frombuffer(whole.content, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert np.corrcoef(shown.ravel(), frame(2).ravel())[0, 1] > 0.95


def test_a_picture_is_kept_for_ever_only_under_the_address_of_its_content(house: House) -> None:
    ready = house.ready()
    address = f"experiments/{ready['id']}/frames/0.webp"
    plain = house.api.get(address)
    assert plain.headers["cache-control"] == "private, no-cache"
    again = house.api.get(address, headers={"If-None-Match": plain.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    versioned = house.api.get(address, params={"v": ready["stack"]["checksum"]})
    assert "immutable" in versioned.headers["cache-control"]
    stale = house.api.get(address, params={"v": "0" * 64})
    assert "immutable" not in stale.headers["cache-control"]


@pytest.mark.parametrize(("index", "status"), [("6", 404), ("-1", 422), ("99999999999999999999", 422), ("x", 422)])
def test_a_frame_that_is_not_there_is_not_found(house: House, index: str, status: int) -> None:
    ready = house.ready()
    assert house.api.get(f"experiments/{ready['id']}/frames/{index}.webp").status_code == status


def test_there_is_no_picture_before_the_stack_is_ready(house: House) -> None:
    answer = house.api.get(f"experiments/{house.experiment()['id']}/frames/0.webp")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.stack_not_ready"
