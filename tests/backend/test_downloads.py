"""Downloads: whole, by range, resumed, and never mixed up."""

import base64
import hashlib
import io
import zipfile
from urllib.parse import unquote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.platform.downloads import content_disposition
from tests.films import Upload, frame, png
from tests.house import House, Json


@pytest.fixture(scope="module")
def finished(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


NAMES = ["trajectories.parquet", "flow.zarr.zip", "summary.json"]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_comes_whole_with_all_that_is_needed_to_check_and_resume_it(
    shared_house: House, finished: Json, name: str
) -> None:
    answer = shared_house.api.get(f"runs/{finished['id']}/files/{name}")
    assert answer.status_code == 200
    assert answer.headers["accept-ranges"] == "bytes"
    assert int(answer.headers["content-length"]) == len(answer.content)
    digest = base64.b64encode(hashlib.sha256(answer.content).digest()).decode()
    assert answer.headers["repr-digest"] == f"sha-256=:{digest}:"
    (listed,) = [
        file
        for file in shared_house.ok(shared_house.api.get(f"runs/{finished['id']}/files"))["items"]
        if file["name"] == name
    ]
    assert listed["sha256"] == hashlib.sha256(answer.content).hexdigest()
    again = shared_house.api.get(
        f"runs/{finished['id']}/files/{name}", headers={"If-None-Match": answer.headers["etag"]}
    )
    assert (again.status_code, again.content) == (304, b"")


@pytest.mark.parametrize("name", NAMES)
def test_the_parts_of_a_file_make_the_file(shared_house: House, finished: Json, name: str) -> None:
    path = f"runs/{finished['id']}/files/{name}"
    whole = shared_house.api.get(path).content
    n = len(whole)
    for said, start, stop in [
        ("bytes=0-99", 0, 100),
        ("bytes=100-", 100, n),
        ("bytes=-10", n - 10, n),
        (f"bytes={n - 1}-", n - 1, n),
        (f"bytes=5-{n + 1000}", 5, n),
        (f"bytes=-{n + 1000}", 0, n),
    ]:
        answer = shared_house.api.get(path, headers={"Range": said})
        assert answer.status_code == 206, said
        assert answer.content == whole[start:stop], said
        assert answer.headers["content-range"] == f"bytes {start}-{stop - 1}/{n}"
        assert int(answer.headers["content-length"]) == stop - start


@pytest.mark.parametrize("said", ["bytes=0-1,5-6", "bytes=9-5", "lines=1-2", "bytes=-", "bytes=a-b", "bytes"])
def test_a_strange_range_is_not_heard(shared_house: House, finished: Json, said: str) -> None:
    path = f"runs/{finished['id']}/files/summary.json"
    answer = shared_house.api.get(path, headers={"Range": said})
    assert (answer.status_code, answer.content) == (200, shared_house.api.get(path).content)


@pytest.mark.parametrize("said", ["bytes=100000000-", "bytes=-0"])
def test_a_range_behind_the_end_is_refused(shared_house: House, finished: Json, said: str) -> None:
    path = f"runs/{finished['id']}/files/summary.json"
    answer = shared_house.api.get(path, headers={"Range": said})
    assert answer.status_code == 416
    assert answer.headers["content-range"] == f"bytes */{len(shared_house.api.get(path).content)}"
    assert answer.json()["code"] == "request.range_not_satisfiable"


def test_a_part_of_something_else_is_not_resumed(shared_house: House, finished: Json) -> None:
    path = f"runs/{finished['id']}/files/summary.json"
    whole = shared_house.api.get(path)
    same = shared_house.api.get(path, headers={"Range": "bytes=10-", "If-Range": whole.headers["etag"]})
    other = shared_house.api.get(path, headers={"Range": "bytes=10-", "If-Range": '"other"'})
    assert (same.status_code, same.content) == (206, whole.content[10:])
    assert (other.status_code, other.content) == (200, whole.content)


def test_the_flow_field_is_an_archive(shared_house: House, finished: Json) -> None:
    content = shared_house.api.get(f"runs/{finished['id']}/files/flow.zarr.zip").content
    assert zipfile.ZipFile(io.BytesIO(content)).testzip() is None


def test_an_uploaded_file_comes_back_as_it_was_under_the_name_it_had(house: House) -> None:
    experiment = house.experiment()
    content = png(frame(0))
    for name in ('Versuch 7/größe 水 "1".png', "plain.png"):
        house.upload(experiment, Upload(name, content))
        (file,) = house.ok(house.api.get(f"experiments/{experiment['id']}/files", params={"q": name}))["items"]
        answer = house.api.get(f"experiments/{experiment['id']}/files/{file['id']}")
        assert answer.content == content
        assert answer.headers["content-type"] == "application/octet-stream"
        assert answer.headers["content-disposition"] == content_disposition(name)
        part = house.api.get(f"experiments/{experiment['id']}/files/{file['id']}", headers={"Range": "bytes=9-19"})
        assert (part.status_code, part.content) == (206, content[9:20])
    other = house.api.get(f"experiments/{house.experiment()['id']}/files/{file['id']}")
    assert (other.status_code, other.json()["code"]) == (404, "not_found.file")


@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=1).filter(lambda name: not name.endswith("/")))
def test_any_name_goes_into_a_header_and_comes_out_again(name: str) -> None:
    value = content_disposition(name)
    assert value.isascii()
    assert value.isprintable()
    plain, _, encoded = value.removeprefix("attachment; ").partition("; filename*=UTF-8''")
    assert plain.startswith('filename="')
    assert plain.count('"') == 2
    assert (unquote(encoded) or plain[10:-1]) == name.rsplit("/", 1)[-1]
