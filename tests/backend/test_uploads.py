"""Files on their way in: whole, or not at all."""

import hashlib
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from backend.platform.settings import Settings
from tests.films import EXPERIMENT, Upload, film, frame, png, tiff
from tests.house import House, open_house

FRAME = Upload("frame.tif", tiff(frame(0)))


@pytest.fixture
def small_house(settings: Settings) -> Iterator[House]:
    with open_house(settings.model_copy(update={"max_file_bytes": 50_000, "max_stack_bytes": 80_000})) as house:
        yield house


def test_a_file_is_kept_byte_for_byte_under_a_key_that_is_not_its_name(house: House) -> None:
    experiment = house.experiment()
    name = "Messung 1/Bild (ä) #1 100%.tif"
    answer = house.ok(house.put(experiment, Upload(name, FRAME.content)), 201)
    assert answer["name"] == name
    assert answer["sha256"] == hashlib.sha256(FRAME.content).hexdigest()
    assert answer["size_bytes"] == len(FRAME.content)
    (kept,) = house.kept_objects()
    assert (house.objects / kept).read_bytes() == FRAME.content
    assert "Bild" not in kept
    assert house.again(experiment)["stack"]["state"] == "uploading"
    assert house.again(experiment)["stack"]["size_bytes"] == len(FRAME.content)


def test_the_same_name_again_replaces_the_file(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, FRAME, Upload(FRAME.name, png(frame(1))))
    (listed,) = house.ok(house.api.get(f"experiments/{experiment['id']}/files"))["items"]
    assert listed["sha256"] == hashlib.sha256(png(frame(1))).hexdigest()
    assert len(house.kept_objects()) == 1


def test_files_sent_at_once_all_arrive(house: House) -> None:
    experiment = house.experiment()
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda file: house.put(experiment, file), film(24)))
    assert [answer.status_code for answer in answers] == [201] * 24
    assert house.again(experiment)["stack"]["n_files"] == 24


def test_files_are_listed_page_by_page(house: House) -> None:
    experiment = house.experiment()
    house.upload(experiment, *film(5))
    first = house.ok(house.api.get(f"experiments/{experiment['id']}/files", params={"limit": 3}))
    assert len(first["items"]) == 3
    rest = house.ok(
        house.api.get(f"experiments/{experiment['id']}/files", params={"limit": 3, "cursor": first["next_cursor"]})
    )
    assert rest["next_cursor"] is None
    assert [file["name"] for file in first["items"] + rest["items"]] == [file.name for file in film(5)]


@pytest.mark.parametrize(
    "name", ["", "/etc/passwd", "../up.tif", "a/../../b.tif", "a\\b.tif", "a\0b", "a\nb", "x" * 1001, "a/"]
)
def test_a_name_that_is_none_is_refused(house: House, name: str) -> None:
    experiment = house.experiment()
    answer = house.put(experiment, Upload(name, FRAME.content))
    assert answer.status_code == 422
    assert answer.json()["code"] == "upload.name"
    assert house.kept_objects() == []


@pytest.mark.parametrize(
    ("file", "status", "code"),
    [
        (Upload("fake.tif", b"MZ" + bytes(1000)), 415, "frames.not_an_image"),
        (Upload("page.tif", b"<html>" + b" " * 1000), 415, "frames.not_an_image"),
        (Upload("short.png", b"\x89P"), 415, "frames.not_an_image"),
        (Upload("empty.tif", b""), 422, "upload.empty"),
        (Upload("archive.zip", b"PK\x03\x04" + bytes(1000), "flat_field"), 415, "frames.not_an_image"),
        (Upload("times.csv", tiff(frame(0)), "timestamps"), 415, "upload.not_csv"),
        (Upload("times.csv", b"time_s\n\0", "temperature_log"), 415, "upload.not_csv"),
    ],
)
def test_content_that_is_not_what_its_role_needs_is_refused_and_not_kept(
    house: House, file: Upload, status: int, code: str
) -> None:
    experiment = house.experiment()
    answer = house.put(experiment, file)
    assert (answer.status_code, answer.json()["code"], answer.json()["file"]) == (status, code, file.name)
    assert house.kept_objects() == []
    assert house.again(experiment)["stack"]["state"] == "empty"


def test_a_role_that_is_none_is_refused(house: House) -> None:
    answer = house.put(house.experiment(), Upload("a.tif", FRAME.content, "wallpaper"))
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "role"


def test_a_file_or_stack_that_is_too_large_is_refused_whether_its_size_is_told_or_not(small_house: House) -> None:
    experiment = small_house.experiment()
    about = {"name": "big.tif"}
    big = FRAME.content + bytes(50_000)
    told = small_house.api.put(f"experiments/{experiment['id']}/files", params=about, content=big)
    streamed = small_house.api.put(
        f"experiments/{experiment['id']}/files",
        params=about,
        content=(big[start : start + 10_000] for start in range(0, len(big), 10_000)),
    )
    for answer in (told, streamed):
        assert answer.status_code == 413
        assert answer.json()["code"] == "upload.too_large"
    small_house.upload(experiment, FRAME, Upload("second.tif", FRAME.content))
    third = small_house.put(experiment, Upload("third.tif", FRAME.content))
    assert third.status_code == 413
    assert "stack" in third.json()["detail"]
    assert len(small_house.kept_objects()) == 2
    small_house.upload(experiment, Upload("second.tif", FRAME.content))


def test_a_cut_upload_leaves_nothing(house: House) -> None:
    experiment = house.experiment()
    address = (house.api.base_url.host, house.api.base_url.port)
    for n_sent in (0, 4, 20_000, 3_000_000):
        content = (FRAME.content * 100)[:n_sent]
        with socket.create_connection(address) as connection:
            connection.sendall(
                f"PUT /api/v1/experiments/{experiment['id']}/files?name=cut.tif HTTP/1.1\r\n"
                f"Host: {address[0]}\r\nContent-Length: 9000000\r\n\r\n".encode()
                + content
            )
    _await(lambda: not _files_below(house.objects))
    assert house.again(experiment)["stack"]["state"] == "empty"
    assert house.ok(house.api.get(f"experiments/{experiment['id']}/files"))["items"] == []


def test_no_file_can_be_added_to_a_stack_that_is_complete(house: House) -> None:
    ready = house.ready()
    answer = house.put(ready, FRAME)
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.stack_closed"
    assert len([key for key in house.kept_objects() if "/files/" in key]) == len(film())


def test_an_upload_to_an_experiment_that_is_not_there_is_refused(house: House) -> None:
    answer = house.put({"id": "00000000-0000-4000-8000-00000000dead"}, FRAME)
    assert answer.status_code == 404
    assert answer.json()["code"] == "not_found.experiment"
    assert house.kept_objects() == []


def test_files_and_document_must_agree_before_the_index(house: House) -> None:
    unnamed = house.experiment()
    house.upload(unnamed, FRAME, Upload("flat.tif", FRAME.content, "flat_field"))
    missing = house.experiment(flat_field="flat.tif")
    house.upload(missing, FRAME)
    other = house.experiment(flat_field="flat.tif")
    house.upload(other, FRAME, Upload("other.tif", FRAME.content, "flat_field"))
    for experiment in (unnamed, missing, other):
        answer = house.api.post(f"experiments/{experiment['id']}/stack")
        assert answer.status_code == 422
        assert answer.json()["code"] == "experiment.invalid"
        assert [found["field"] for found in answer.json()["errors"]] == ["flat_field"]
        assert house.again(experiment)["stack"]["state"] == "uploading"


def test_an_index_needs_frames(house: House) -> None:
    experiment = house.experiment()
    answer = house.api.post(f"experiments/{experiment['id']}/stack")
    assert answer.status_code == 409
    assert answer.json()["code"] == "conflict.stack_empty"
    assert experiment["experiment"]["name"] == EXPERIMENT["name"]


def _await(condition: object, timeout_s: float = 10.0) -> None:
    deadline = time.monotonic() + timeout_s
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < deadline
        time.sleep(0.05)


def _files_below(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file()]
