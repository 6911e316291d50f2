"""What people and programs get wrong about tokens, names, sizes and numbers: a clear answer each."""

from datetime import timedelta
from uuid import uuid4

import httpx
import pytest
from sqlalchemy import insert

from backend.models import Experiment, Right, Scope, Stack
from backend.models.states import StackState
from backend.platform.settings import Settings
from backend.previews import service as previews
from tests.films import EXPERIMENT
from tests.house import House, open_house
from tests.lab import Lab

N_EXPERIMENTS = 10_000
NAMES = [
    "Größenverteilung 1 µm → 2 µm",
    "液滴の合体",
    "قطرات",
    "💧🔬",
    "e\u0301 is é",
    "x" * 200,
    "'; DROP TABLE run; --",
    "%s %n",
]


def told(answer: httpx.Response) -> tuple[int, str]:
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["detail"]
    return answer.status_code, answer.json()["code"]


def test_a_wrong_expired_or_revoked_token_is_told_apart(lab: Lab) -> None:
    ada = lab.person("Ada")
    api = str(lab.house.api.base_url)
    for wrong in ("df_made-up", "x", "ü".encode().decode("latin-1")):
        answer = httpx.get(f"{api}session", headers={b"Authorization": f"Bearer {wrong}".encode("latin-1")})
        assert told(answer) == (401, "token.unknown"), wrong
    expired = lab.program(ada, Scope.READ, lasts=-timedelta(days=1))
    assert told(expired.get("experiments")) == (401, "token.expired")
    browser = lab.browser(ada)
    made = browser.post("tokens", json={"name": "mine"}).json()
    headers = {"Authorization": f"Bearer {made['secret']}"}
    assert httpx.get(f"{api}experiments", headers=headers).status_code == 200
    browser.delete(f"tokens/{made['id']}").raise_for_status()
    assert told(httpx.get(f"{api}experiments", headers=headers)) == (401, "token.unknown")


def test_a_token_of_another_person_opens_nothing_and_cannot_be_revoked(lab: Lab) -> None:
    group = lab.group("Foams")
    experiment, run = lab.finished(group)
    lab.person("Ada", {group: Right.MANAGE})
    eve = lab.person("Eve")
    foreign = lab.program(eve, Scope.ADMIN)
    for path in (f"experiments/{experiment}", f"runs/{run}", f"groups/{group}", f"groups/{group}/webhooks"):
        assert foreign.get(path).status_code == 404, path
    grace = lab.browser(lab.person("Grace"))
    hers = grace.post("tokens", json={"name": "hers"}).json()
    assert told(foreign.delete(f"tokens/{hers['id']}")) == (404, "not_found.token")
    assert told(lab.program(eve, Scope.READ).post("experiments", json={"experiment": EXPERIMENT})) == (
        403,
        "forbidden.scope",
    )


def test_a_key_of_somebody_else_creates_for_oneself(lab: Lab) -> None:
    """Keys are everybody's own: one that is guessed answers nothing of another person's."""
    ada, eve = (lab.program(lab.person(name), Scope.SUBMIT) for name in ("Ada", "Eve"))
    key = {"Idempotency-Key": str(uuid4())}
    first = ada.post("experiments", json={"experiment": EXPERIMENT}, headers=key)
    other = eve.post("experiments", json={"experiment": EXPERIMENT}, headers=key)
    assert (first.status_code, other.status_code) == (201, 201)
    assert first.json()["id"] != other.json()["id"]
    changed = ada.post("experiments", json={"experiment": {**EXPERIMENT, "name": "other"}}, headers=key)
    assert told(changed) == (422, "idempotency.other_request")


@pytest.mark.parametrize("is_told", [True, False])
def test_json_that_is_too_large_is_refused_whether_its_size_is_told_or_not(house: House, is_told: bool) -> None:
    body = b'{"experiment": {"name": "' + b"x" * 1_000_001 + b'"}}'
    content = body if is_told else (body[start : start + 65_536] for start in range(0, len(body), 65_536))
    answer = house.api.post("experiments", content=content, headers={"Content-Type": "application/json"})
    assert told(answer) == (413, "request.too_large")


def test_json_that_is_too_deep_or_a_number_without_end_is_refused(house: House) -> None:
    headers = {"Content-Type": "application/json"}
    for body in (b"[" * 100_000, b'{"a":' * 50_000, b'{"experiment": {"pixel_size_um": ' + b"9" * 5_000 + b"}}"):
        assert told(house.api.post("experiments", content=body, headers=headers)) in (
            (400, "request.invalid"),
            (422, "request.invalid"),
            (422, "experiment.invalid"),
        )
    for number in ("NaN", "Infinity", "1e999"):
        body = b'{"experiment": {"name": "a", "pixel_size_um": %s, "frame_interval_s": 1}}' % number.encode()
        assert told(house.api.post("experiments", content=body, headers=headers))[0] == 422, number


@pytest.mark.parametrize("name", NAMES)
def test_any_name_comes_back_as_it_was_given_and_is_found_by(lab: Lab, name: str) -> None:
    browser = lab.browser(lab.person("Ada"))
    made = browser.post("experiments", json={"experiment": EXPERIMENT | {"name": name}})
    assert made.status_code == 201, made.text
    assert browser.get(f"experiments/{made.json()['id']}").json()["experiment"]["name"] == name
    found = browser.get("experiments", params={"q": name}).json()["items"]
    assert [item["id"] for item in found] == [made.json()["id"]]
    group = browser.post("groups", json={"name": name}).json()
    assert browser.get(f"groups/{group['id']}").json()["name"] == name
    assert browser.post("tokens", json={"name": name}).json()["name"] == name


@pytest.mark.slow
def test_ten_thousand_experiments_are_listed_each_once_and_only_to_who_may_see_them(lab: Lab) -> None:
    group = lab.group("Many")
    program = lab.program(lab.person("Ada", {group: Right.VIEW}), Scope.READ)
    ids = [uuid4() for _ in range(N_EXPERIMENTS)]
    with lab.house.context.sessions.begin() as session:
        rows = [{"id": found, "group_id": group, "document": EXPERIMENT} for found in ids]
        session.execute(insert(Experiment), rows)
        stacks = [{"experiment_id": found, "state": StackState.EMPTY, "warnings": []} for found in ids]
        session.execute(insert(Stack), stacks)
    seen, cursor = [], None
    while True:
        page = program.get("experiments", params={"limit": 500} | ({"cursor": cursor} if cursor else {})).json()
        seen += [item["id"] for item in page["items"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert sorted(seen) == sorted(map(str, ids))
    assert lab.program(lab.person("Eve"), Scope.READ).get("experiments").json()["items"] == []


def test_whoever_looks_at_too_many_frames_is_told_to_wait(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(previews, "LOOKS_PER_MINUTE", 3)
    with open_house(settings) as house:
        experiment = house.experiment()
        asked = [house.api.post(f"experiments/{experiment['id']}/previews", json={"frame": 0}) for _ in range(5)]
    assert [answer.status_code for answer in asked] == [409, 409, 409, 429, 429]
    assert told(asked[-1]) == (429, "request.too_often")
    assert asked[-1].headers["retry-after"] == "60"
