"""Uploads cut at any byte, sent twice at once, into a full disk and into S3: the bytes that count are always right."""

import hashlib
import os
import random
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import numpy as np
import psutil
import pytest

from backend.platform import growing
from backend.platform.settings import Settings
from tests import s3
from tests.films import EXPERIMENT, Upload, film
from tests.house import House, Json, open_house
from tests.sending import BYTES, TUS, content_of, cut_patch, offset, patch, plan
from tests.services import RunningService


def _noise(n_bytes: int, name: str = "big.tif") -> Upload:
    content = np.random.default_rng(5).integers(0, 255, n_bytes, np.uint8).tobytes()
    return Upload(name, b"II*\0" + content[4:])


def _files(house: House, experiment: Json) -> dict[str, str]:
    listed = house.ok(house.api.get(f"experiments/{experiment['id']}/files", params={"limit": 500}))["items"]
    return {file["name"]: file["sha256"] for file in listed}


def _sums(*files: Upload) -> dict[str, str]:
    return {file.name: hashlib.sha256(file.content).hexdigest() for file in files}


@pytest.mark.parametrize("n_cuts", [6, pytest.param(50, marks=pytest.mark.slow)])
def test_an_upload_cut_at_random_bytes_arrives_as_it_was(house: House, n_cuts: int) -> None:
    random_bytes = random.Random(n_cuts)
    experiment = house.experiment()
    file = _noise(n_cuts * 400_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    for _ in range(n_cuts):
        reached = _free_offset(house, upload["location"])
        rest = file.content[reached:]
        cut_patch(house, upload["location"], reached, rest, random_bytes.randrange(min(len(rest), 700_000)))
    reached = _free_offset(house, upload["location"])
    assert reached < len(file.content)
    assert patch(house, upload["location"], reached, file.content[reached:]).status_code == 204
    assert _files(house, experiment) == _sums(file)


def test_two_tabs_that_send_the_same_files_end_with_one_right_copy(house: House) -> None:
    experiment = house.experiment()
    files = [*film(20), _noise(8_000_000)]
    problems: list[BaseException] = []

    def tab() -> None:
        try:
            _send_until_there(house, experiment, files)
        except BaseException as problem:
            problems.append(problem)

    tabs = [threading.Thread(target=tab) for _ in range(2)]
    for one in tabs:
        one.start()
    for one in tabs:
        one.join()
    assert problems == []
    assert _files(house, experiment) == _sums(*files)
    assert len(house.kept_objects()) == 1
    assert house.ok(house.api.get(f"experiments/{experiment['id']}/uploads"))["n_files_missing"] == 0


def test_a_disk_that_gets_full_says_so_and_keeps_what_came(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    """The write fails as a full disk's does, after some megabytes, in the real writer."""
    experiment = house.experiment()
    file = _noise(12_000_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    real_write = os.write

    def full(descriptor: int, content: memoryview) -> int:
        if os.lseek(descriptor, 0, os.SEEK_CUR) > 6_000_000:
            raise OSError(28, "No space left on device")
        return real_write(descriptor, content)

    monkeypatch.setattr(growing.os, "write", full)
    answer = patch(house, upload["location"], 0, file.content)
    assert (answer.status_code, answer.json()["code"]) == (507, "upload.no_space")
    assert "kept" in answer.json()["hint"]
    reached = offset(house, upload["location"])
    assert 4_000_000 < reached < 12_000_000
    monkeypatch.undo()
    assert patch(house, upload["location"], reached, file.content[reached:]).status_code == 204
    assert _files(house, experiment) == _sums(file)


@pytest.fixture(scope="module", params=["s3", "failing s3"])
def s3_port(request: pytest.FixtureRequest) -> Iterator[int]:
    with s3.running_s3() as port:
        if request.param == "s3":
            yield port
        else:
            with s3.failing_way(port) as failing:
                yield failing


def test_uploads_to_s3_break_off_go_on_and_become_a_film(
    s3_port: int, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    s3.use(monkeypatch, s3_port)
    with open_house(settings.model_copy(update={"object_store_url": f"s3://{s3.BUCKET}/house"})) as house:
        experiment = house.experiment()
        files = film(12)
        (upload,) = plan(house, experiment, files)["uploads"]
        content = content_of(upload, files)
        third = len(content) // 3
        assert patch(house, upload["location"], 0, content[:third]).status_code == 204
        cut_patch(house, upload["location"], third, content[third:], third)
        reached = _free_offset(house, upload["location"])
        assert third <= reached <= 2 * third
        # Whoever was cut off may hold it a little longer, and have written a little more.
        while (answer := patch(house, upload["location"], reached, content[reached:])).status_code != 204:
            assert answer.status_code in {409, 423}, answer.text
            reached = _free_offset(house, upload["location"])
        assert _files(house, experiment) == _sums(*files)
        stack = house.seal(experiment)["stack"]
        assert (stack["state"], stack["n_frames"]) == ("ready", 12)
        assert house.api.get(f"experiments/{experiment['id']}/frames/11.webp").status_code == 200


@pytest.mark.slow
def test_twenty_thousand_small_files_need_little_memory(service: RunningService, tmp_path: Path) -> None:
    server = psutil.Process(service.children["API"].process.pid)
    files = [
        Upload(f"film/frame{number:05d}.tif", b"II*\0" + number.to_bytes(8, "big") * 500) for number in range(20_000)
    ]
    most_bytes = 0
    with httpx.Client(base_url=f"{service.url}api/v1/", timeout=60) as api:
        experiment = api.post("experiments", json={"experiment": EXPERIMENT}).json()["id"]
        for start in range(0, len(files), 1000):
            part = files[start : start + 1000]
            wanted = {"files": [{"name": file.name, "size_bytes": len(file.content)} for file in part]}
            for upload in api.post(f"experiments/{experiment}/uploads/plan", json=wanted).json()["uploads"]:
                content = b"".join(part[index].content for index in upload["files"])
                sent = api.patch(upload["location"], content=content, headers={**BYTES, "Upload-Offset": "0"})
                assert sent.status_code == 204
                most_bytes = max(most_bytes, server.memory_info().rss)
            assert api.post(f"experiments/{experiment}/uploads/plan", json=wanted).json()["uploads"] == []
        assert api.get(f"experiments/{experiment}").json()["stack"]["n_files"] == 20_000
        api.delete(f"experiments/{experiment}")
    assert most_bytes < 400_000_000


def _send_until_there(house: House, experiment: Json, files: list[Upload]) -> None:
    """What the page does: plan, send, wait where somebody else sends, until all is there."""
    for _ in range(100):
        uploads = plan(house, experiment, files)["uploads"]
        if not uploads:
            return
        for upload in uploads:
            content, at = content_of(upload, files), upload["offset_bytes"]
            sent = patch(house, upload["location"], at, content[at : at + 1_000_000])
            assert sent.status_code in {204, 404, 409, 423}, sent.text
            if sent.status_code == 423:
                time.sleep(0.05)
    raise AssertionError("never there")


def _free_offset(house: House, location: str) -> int:
    """The offset once the server has noticed that the last sender is gone."""
    deadline = time.monotonic() + 20
    while True:
        reached = offset(house, location)
        answer = house.api.patch(location, headers={**BYTES, **TUS, "Upload-Offset": str(reached)}, content=b"")
        if answer.status_code == 204 and int(answer.headers["Upload-Offset"]) == reached:
            return reached
        assert answer.status_code in {204, 409, 423}, answer.text
        assert time.monotonic() < deadline
        time.sleep(0.02)
