"""ETags: nothing is sent twice, and no change is lost."""

import pytest

from tests.films import EXPERIMENT, Upload, frame, png
from tests.house import House


def test_an_answer_that_did_not_change_is_not_sent_again(house: House) -> None:
    made = house.experiment()
    for path in (f"experiments/{made['id']}", "experiments", f"experiments/{made['id']}/files", "schemas/parameters"):
        first = house.api.get(path)
        tag = first.headers["etag"]
        assert first.headers["cache-control"] == "private, no-cache"
        for known in (tag, f"W/{tag}", f'"other", {tag}', "*"):
            again = house.api.get(path, headers={"If-None-Match": known})
            assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
        assert house.api.get(path, headers={"If-None-Match": '"other"'}).content == first.content


def test_an_answer_that_changed_is_sent(house: House) -> None:
    made = house.experiment()
    tag = house.api.get(f"experiments/{made['id']}").headers["etag"]
    house.upload(made, Upload("a.png", png(frame(0))))
    answer = house.api.get(f"experiments/{made['id']}", headers={"If-None-Match": tag})
    assert answer.status_code == 200
    assert answer.headers["etag"] != tag


def test_of_two_who_change_the_same_copy_the_second_is_told(house: House) -> None:
    path = f"experiments/{house.experiment()['id']}"
    copy = {"If-Match": house.api.get(path).headers["etag"]}
    first = house.api.patch(path, json={"experiment": {**EXPERIMENT, "name": "first"}}, headers=copy)
    second = house.api.patch(path, json={"experiment": {**EXPERIMENT, "name": "second"}}, headers=copy)
    assert (first.status_code, second.status_code) == (200, 412)
    assert second.json()["code"] == "conflict.changed_meanwhile"
    assert house.ok(house.api.get(path))["experiment"]["name"] == "first"
    fresh = {"If-Match": first.headers["etag"]}
    third = house.api.patch(path, json={"experiment": {**EXPERIMENT, "name": "third"}}, headers=fresh)
    assert house.ok(third)["experiment"]["name"] == "third"


@pytest.mark.parametrize(("if_match", "status"), [("*", 200), ('"nothing"', 412), ("", 412)])
def test_any_copy_or_none(house: House, if_match: str, status: int) -> None:
    path = f"experiments/{house.experiment()['id']}"
    answer = house.api.patch(path, json={"experiment": EXPERIMENT}, headers={"If-Match": if_match})
    assert answer.status_code == status


def test_what_happens_to_the_frames_makes_no_copy_of_the_document_old(house: House) -> None:
    made = house.experiment()
    path = f"experiments/{made['id']}"
    copy = {"If-Match": house.api.get(path).headers["etag"]}
    house.upload(made, Upload("a.png", png(frame(0))))
    answer = house.api.patch(path, json={"experiment": {**EXPERIMENT, "name": "renamed"}}, headers=copy)
    assert answer.status_code == 200
