"""Uploads that break off anywhere and go on from there: by this sender or another, on this server or the next."""

import base64
import hashlib
import time
from datetime import timedelta

import numpy as np
import pytest
from sqlalchemy import update

from backend.models import Upload as Row
from tests.films import Upload, film, frame, tiff
from tests.house import House, Json
from tests.sending import BYTES, TUS, content_of, cut_patch, offset, patch, plan, send_all


@pytest.fixture
def experiment(house: House) -> Json:
    return house.experiment()


def big_file(n_bytes: int = 6_000_000, name: str = "big.tif", seed: int = 0) -> Upload:
    noise = np.random.default_rng(seed).integers(0, 255, n_bytes, np.uint8).tobytes()
    return Upload(name, b"II*\0" + noise[4:])


def _files(house: House, experiment: Json) -> dict[str, str]:
    listed = house.ok(house.api.get(f"experiments/{experiment['id']}/files", params={"limit": 500}))["items"]
    return {file["name"]: file["sha256"] for file in listed}


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_many_small_files_go_in_one_upload_and_become_a_film(house: House, experiment: Json) -> None:
    files = film(24)
    planned = send_all(house, experiment, files)
    assert len(planned["uploads"]) == 1
    assert _files(house, experiment) == {file.name: _sha256(file.content) for file in files}
    assert len(house.kept_objects()) == 1
    stack = house.seal(experiment)["stack"]
    assert (stack["state"], stack["n_frames"]) == ("ready", 24)
    picture = house.api.get(f"experiments/{experiment['id']}/frames/23.webp")
    assert picture.status_code == 200


def test_the_same_plan_again_sends_only_what_is_missing(house: House, experiment: Json) -> None:
    files = film(6)
    send_all(house, experiment, files[:4])
    again = plan(house, experiment, files)
    assert [found["file"] for found in again["present"]] == [0, 1, 2, 3]
    assert [found["sha256"] for found in again["present"]] == [_sha256(file.content) for file in files[:4]]
    (upload,) = again["uploads"]
    assert upload["files"] == [4, 5]
    assert plan(house, experiment, files)["uploads"] == [upload]
    send_all(house, experiment, files)
    assert plan(house, experiment, files)["uploads"] == []


def test_a_file_of_the_same_name_and_size_with_other_content_is_sent_anew(house: House, experiment: Json) -> None:
    before, after = Upload("a.tif", tiff(frame(0))), Upload("a.tif", tiff(frame(1)))
    send_all(house, experiment, [before])
    assert plan(house, experiment, [after])["uploads"] == []
    (upload,) = plan(house, experiment, [after], sha256=_sha256(after.content))["uploads"]
    assert patch(house, upload["location"], 0, after.content).status_code == 204
    assert _files(house, experiment) == {"a.tif": _sha256(after.content)}
    assert len(house.kept_objects()) == 1


def test_what_came_before_a_cut_stays(house: House, experiment: Json) -> None:
    file = big_file()
    (upload,) = plan(house, experiment, [file])["uploads"]
    cut_patch(house, upload["location"], 0, file.content, 3_000_000)
    reached = _settled(house, upload["location"])
    assert 0 < reached <= 3_000_000
    assert _files(house, experiment) == {}
    again = plan(house, experiment, [file])["uploads"]
    assert [found["offset_bytes"] for found in again] == [reached]
    answer = patch(house, upload["location"], reached, file.content[reached:])
    assert (answer.status_code, answer.headers["Upload-Offset"]) == (204, str(len(file.content)))
    assert _files(house, experiment) == {file.name: _sha256(file.content)}


def test_a_server_that_forgot_everything_in_between_knows_the_right_checksums(house: House, experiment: Json) -> None:
    files = [*film(3), big_file()]
    content = content_of(plan(house, experiment, files)["uploads"][0], files)
    (upload,) = plan(house, experiment, files)["uploads"]
    for start in range(0, len(content), 1_700_000):
        house.app.state.intakes.__init__()
        assert patch(house, upload["location"], start, content[start : start + 1_700_000]).status_code == 204
    assert _files(house, experiment) == {file.name: _sha256(file.content) for file in files}


def test_files_are_recorded_though_the_server_stopped_after_the_last_byte(house: House, experiment: Json) -> None:
    file = big_file(1_000_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    assert patch(house, upload["location"], 0, file.content[:-1]).status_code == 204
    key = house.objects / f"experiments/{experiment['id']}/files/{upload['id']}"
    with key.open("ab") as growing:
        growing.write(file.content[-1:])
    _change(house, upload, offset_bytes=len(file.content))
    assert offset(house, upload["location"]) == len(file.content)
    assert _files(house, experiment) == {file.name: _sha256(file.content)}
    assert patch(house, upload["location"], len(file.content), b"").status_code == 204


def test_bytes_that_were_written_but_not_confirmed_do_not_count(house: House, experiment: Json) -> None:
    file = big_file(1_000_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    assert patch(house, upload["location"], 0, file.content[:400_000]).status_code == 204
    key = house.objects / f"experiments/{experiment['id']}/files/{upload['id']}"
    with key.open("ab") as growing:
        growing.write(b"rubbish from a server that was killed")
    assert offset(house, upload["location"]) == 400_000
    assert patch(house, upload["location"], 400_000, file.content[400_000:]).status_code == 204
    assert _files(house, experiment) == {file.name: _sha256(file.content)}


def test_a_wrong_offset_is_refused_with_the_right_one(house: House, experiment: Json) -> None:
    file = big_file(100_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    patch(house, upload["location"], 0, file.content[:50_000])
    answer = patch(house, upload["location"], 49_999, file.content[49_999:])
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.upload_offset")
    assert answer.headers["Upload-Offset"] == "50000"
    late = patch(house, upload["location"], 50_000, file.content[50_000:] + b"more")
    assert (late.status_code, late.json()["code"]) == (413, "upload.too_long")
    assert offset(house, upload["location"]) == 50_000


def test_two_senders_of_one_upload_do_not_meet(house: House, experiment: Json) -> None:
    file = big_file(100_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    _change(house, upload, fence=7, held_until=Row.created_at + _HOUR)
    answer = patch(house, upload["location"], 0, file.content)
    assert (answer.status_code, answer.json()["code"]) == (423, "upload.in_use")
    assert int(answer.headers["Retry-After"]) > 0
    _change(house, upload, held_until=Row.created_at - _HOUR)
    assert patch(house, upload["location"], 0, file.content).status_code == 204


def test_a_checksum_that_does_not_fit_takes_the_bytes_back(house: House, experiment: Json) -> None:
    file = big_file(300_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    half = file.content[:150_000]
    for algorithm in ("sha256", "sha1", "md5"):
        digest = hashlib.new(algorithm, b"other bytes", usedforsecurity=False).digest()
        wrong = {"Upload-Checksum": f"{algorithm} {base64.b64encode(digest).decode()}"}
        answer = patch(house, upload["location"], 0, half, wrong)
        assert (answer.status_code, answer.json()["code"]) == (460, "upload.checksum")
        assert offset(house, upload["location"]) == 0
    right = {"Upload-Checksum": f"sha256 {base64.b64encode(hashlib.sha256(half).digest()).decode()}"}
    assert patch(house, upload["location"], 0, half, right).status_code == 204
    for header in ("crc32 AAAA", "sha256 AAAA", "sha256 ?"):
        answer = patch(house, upload["location"], 150_000, half, {"Upload-Checksum": header})
        assert (answer.status_code, answer.json()["errors"][0]["field"]) == (400, "Upload-Checksum")
    assert patch(house, upload["location"], 150_000, file.content[150_000:]).status_code == 204
    assert _files(house, experiment) == {file.name: _sha256(file.content)}


def test_a_file_whose_announced_checksum_does_not_fit_is_sent_again(house: House, experiment: Json) -> None:
    file = big_file(10_000)
    (upload,) = plan(house, experiment, [file], sha256="0" * 64)["uploads"]
    answer = patch(house, upload["location"], 0, file.content)
    assert (answer.status_code, answer.json()["code"], answer.json()["file"]) == (460, "upload.checksum", file.name)
    assert offset(house, upload["location"]) == 0
    assert _files(house, experiment) == {}


def test_a_file_that_is_no_image_is_refused_and_stays_refused(house: House, experiment: Json) -> None:
    files = [*film(2), Upload("film/virus.tif", b"MZ" + bytes(5000))]
    (upload,) = plan(house, experiment, files)["uploads"]
    answer = patch(house, upload["location"], 0, content_of(upload, files))
    assert (answer.status_code, answer.json()["code"]) == (415, "frames.not_an_image")
    assert answer.json()["file"] == "film/virus.tif"
    assert house.api.head(upload["location"], headers=TUS).status_code == 415
    looked = house.ok(house.api.get(upload["location"]))
    assert (looked["state"], looked["problem"]["file"]) == ("refused", "film/virus.tif")
    assert house.kept_objects() == []
    send_all(house, experiment, files[:2])
    assert len(_files(house, experiment)) == 2
    assert house.seal(experiment)["stack"]["state"] == "ready"


def test_announced_files_that_did_not_arrive_hold_back_the_index(house: House, experiment: Json) -> None:
    files = film(6)
    send_all(house, experiment, files[:3])
    plan(house, experiment, files)
    missing = house.ok(house.api.get(f"experiments/{experiment['id']}/uploads"))
    assert missing["n_files_missing"] == 3
    assert missing["n_bytes_missing"] == sum(len(file.content) for file in files[3:])
    assert missing["items"][0]["first_name"] == files[3].name
    answer = house.api.post(f"experiments/{experiment['id']}/stack")
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.files_missing")
    house.ok(house.api.post(f"experiments/{experiment['id']}/stack", params={"missing": "leave_out"}), 202)
    house.work()
    assert house.again(experiment)["stack"]["n_frames"] == 3
    assert len(house.kept_objects()) == 2


def test_a_part_of_what_was_begun_can_be_sent_alone_and_the_rest_stays_announced(
    house: House, experiment: Json
) -> None:
    files = film(6)
    (first,) = plan(house, experiment, files)["uploads"]
    patch(house, first["location"], 0, content_of(first, files)[:1000])
    send_all(house, experiment, files[2:4])
    assert set(_files(house, experiment)) == {file.name for file in files[2:4]}
    assert house.ok(house.api.get(f"experiments/{experiment['id']}/uploads"))["n_files_missing"] == 4
    send_all(house, experiment, files)
    assert len(_files(house, experiment)) == 6
    assert house.ok(house.api.get(f"experiments/{experiment['id']}/uploads"))["n_files_missing"] == 0


def test_an_upload_can_be_given_up(house: House, experiment: Json) -> None:
    file = big_file(100_000)
    (upload,) = plan(house, experiment, [file])["uploads"]
    patch(house, upload["location"], 0, file.content[:50_000])
    assert house.api.delete(upload["location"], headers=TUS).status_code == 204
    assert house.api.head(upload["location"], headers=TUS).status_code == 404
    assert house.api.delete(upload["location"], headers=TUS).json()["code"] == "not_found.upload"
    assert house.kept_objects() == []


def test_a_plain_tus_client_is_understood(house: House, experiment: Json) -> None:
    url = f"experiments/{experiment['id']}/uploads"
    options = house.api.options(url)
    assert options.status_code == 204
    assert set(options.headers["Tus-Extension"].split(",")) == {
        "creation",
        "creation-with-upload",
        "checksum",
        "expiration",
        "termination",
    }
    file = big_file(70_000, "run 1/Bild ä.tif")
    about = {
        "Upload-Length": str(len(file.content)),
        "Upload-Metadata": f"filename {_base64(file.name)},role {_base64('frames')}",
    }
    created = house.api.post(url, headers={**TUS, **about})
    assert created.status_code == 201
    location = house.api.base_url.join(f"experiments/{experiment['id']}/").join(created.headers["Location"])
    assert not created.headers["Location"].startswith(("/", "http"))
    assert created.headers["Upload-Expires"].endswith("GMT")
    assert patch(house, str(location), 0, file.content).status_code == 204
    second = house.api.post(url, headers={**BYTES, **about}, content=file.content[:30_000])
    assert (second.status_code, second.headers["Upload-Offset"]) == (201, "30000")
    assert _files(house, experiment) == {file.name: _sha256(file.content)}


@pytest.mark.parametrize(
    ("headers", "status", "field"),
    [
        ({"Tus-Resumable": "0.2.2"}, 412, None),
        ({"Upload-Length": "many"}, 400, "Upload-Length"),
        ({"Upload-Metadata": "filename ???"}, 400, "Upload-Metadata"),
        ({"Upload-Metadata": ""}, 400, "Upload-Metadata"),
        ({"Upload-Metadata": "filename YS50aWY=,role d2FsbHBhcGVy"}, 400, "Upload-Metadata"),
        ({"Upload-Defer-Length": "1"}, 400, "Upload-Defer-Length"),
    ],
)
def test_headers_that_make_no_sense_are_refused(
    house: House, experiment: Json, headers: dict[str, str], status: int, field: str | None
) -> None:
    right = {**TUS, "Upload-Length": "10", "Upload-Metadata": "filename YS50aWY="}
    answer = house.api.post(f"experiments/{experiment['id']}/uploads", headers={**right, **headers})
    assert answer.status_code == status
    assert [found["field"] for found in answer.json()["errors"]] == ([field] if field else [])


@pytest.mark.parametrize(
    ("file", "status", "code"),
    [
        ({"name": "../a.tif", "size_bytes": 5}, 422, "upload.name"),
        ({"name": "a.tif", "size_bytes": 0}, 422, "upload.empty"),
        ({"name": "a.tif", "size_bytes": 10**15}, 413, "upload.too_large"),
        ({"name": "a.csv", "size_bytes": 10**9, "role": "timestamps"}, 413, "upload.too_large"),
        ({"name": "a.tif", "size_bytes": -1}, 422, "request.invalid"),
    ],
)
def test_a_file_that_cannot_be_taken_is_refused_before_it_is_sent(
    house: House, experiment: Json, file: Json, status: int, code: str
) -> None:
    answer = house.api.post(f"experiments/{experiment['id']}/uploads/plan", json={"files": [file]})
    assert (answer.status_code, answer.json()["code"]) == (status, code)


def test_a_disk_that_cannot_hold_it_says_so_before_the_first_byte(house: House, experiment: Json) -> None:
    free = house.context.store.free_bytes()
    assert free is not None
    wanted = [{"name": f"{number}.tif", "size_bytes": 90_000_000_000} for number in range(2)]
    if free > 180_000_000_000:
        pytest.skip("this disk is larger than the largest stack")
    answer = house.api.post(f"experiments/{experiment['id']}/uploads/plan", json={"files": wanted})
    assert (answer.status_code, answer.json()["code"]) == (507, "upload.no_space")
    assert house.ok(house.api.get(f"experiments/{experiment['id']}/uploads"))["n_files_missing"] == 0


def test_nothing_can_be_sent_to_a_stack_that_is_complete(house: House, experiment: Json) -> None:
    send_all(house, experiment, film())
    house.seal(experiment)
    answer = house.api.post(
        f"experiments/{experiment['id']}/uploads/plan", json={"files": [{"name": "late.tif", "size_bytes": 9}]}
    )
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.stack_closed")


def test_removing_the_frames_removes_what_was_begun(house: House, experiment: Json) -> None:
    send_all(house, experiment, film(3))
    (upload,) = plan(house, experiment, [big_file()])["uploads"]
    patch(house, upload["location"], 0, big_file().content[:100])
    house.ok(house.api.delete(f"experiments/{experiment['id']}/stack"))
    assert house.kept_objects() == []
    assert house.again(experiment)["stack"]["state"] == "empty"


_HOUR = timedelta(hours=1)


def _change(house: House, upload: Json, **values: object) -> None:
    with house.context.sessions.begin() as session:
        session.execute(update(Row).where(Row.id == upload["id"]).values(**values))


def _settled(house: House, location: str, timeout_s: float = 5.0) -> int:
    """The offset once the server has noticed a cut."""
    deadline = time.monotonic() + timeout_s
    reached = offset(house, location)
    while reached == 0:
        assert time.monotonic() < deadline
        time.sleep(0.02)
        reached = offset(house, location)
    return reached


def _base64(text: str) -> str:
    return base64.b64encode(text.encode()).decode()
