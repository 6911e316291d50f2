"""What somebody who means harm would try against sign-in and cookies."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import redis

from backend.models import Right
from backend.platform.identity import session_cookie
from backend.platform.settings import Settings
from deploy.local.valkey import Valkey
from tests.films import EXPERIMENT
from tests.lab import ADDRESS, Lab, lab_settings, open_lab
from tests.services import running_valkey

PASSWORD = "correct horse battery staple"  # noqa: S105


def test_session_fixation_a_planted_cookie_is_not_the_one_that_is_signed_in(lab: Lab) -> None:
    ada = lab.person("Ada", password=PASSWORD)
    browser = lab.nobody()
    browser.cookies.set(session_cookie(lab.settings), "planted")
    browser.post("session", json={"email": lab.email(ada), "password": PASSWORD}).raise_for_status()
    planted = lab.nobody()
    planted.cookies.set(session_cookie(lab.settings), "planted")
    assert planted.get("account").status_code == 401


def test_session_fixation_signing_in_ends_the_session_that_was_there(lab: Lab) -> None:
    eve, ada = lab.person("Eve"), lab.person("Ada", password=PASSWORD)
    browser = lab.browser(eve)
    before = dict(browser.cookies)
    browser.post("session", json={"email": lab.email(ada), "password": PASSWORD}).raise_for_status()
    old = lab.nobody()
    old.cookies.update(before)
    assert old.get("account").status_code == 401


FOREIGN = [
    {"Origin": "https://evil.example"},
    {"Origin": "null"},
    {"Origin": ADDRESS.rstrip("/") + ".evil.example"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"},
    {},
]


@pytest.mark.parametrize("headers", FOREIGN)
def test_request_forgery_a_page_from_elsewhere_changes_nothing(lab: Lab, headers: dict[str, str]) -> None:
    group = lab.group("Foams")
    browser = lab.browser(lab.person("Ada", {group: Right.MANAGE}))
    del browser.headers["Origin"]
    experiment, _ = lab.finished(group)
    for method, path, body in (
        ("DELETE", f"experiments/{experiment}", None),
        ("POST", "experiments", {"experiment": EXPERIMENT}),
        ("POST", "tokens", {"name": "stolen", "scope": "admin"}),
        ("DELETE", "session", None),
        ("POST", "session", {"email": "eve@evil.example", "password": "her own"}),
    ):
        answer = browser.request(method, path, json=body, headers=headers)
        assert (answer.status_code, answer.json()["code"]) == (403, "request.foreign_origin"), (method, path)
    assert browser.get(f"experiments/{experiment}").status_code == 200


def test_request_forgery_no_page_from_elsewhere_may_read_answers(lab: Lab) -> None:
    browser = lab.browser(lab.person("Ada"))
    asked = {"Origin": "https://evil.example", "Access-Control-Request-Method": "DELETE"}
    for answer in (browser.get("session", headers=asked), browser.request("OPTIONS", "session", headers=asked)):
        assert not [name for name in answer.headers if name.startswith("access-control-")]


ELSEWHERE = ["//evil.example/", "/\\evil.example", "/https://evil.example", "/sign-in?next=//evil.example"]


@pytest.mark.parametrize("path", ELSEWHERE)
def test_open_redirect_no_address_of_ours_leads_elsewhere(lab: Lab, path: str) -> None:
    root = str(lab.house.api.base_url).removesuffix("/api/v1/")
    answer = httpx.get(httpx.URL(root).copy_with(raw_path=path.encode()), follow_redirects=False)
    assert "location" not in answer.headers


def test_header_injection_a_name_with_a_line_break_is_refused(lab: Lab) -> None:
    browser = lab.browser(lab.person("Ada"))
    name = "a\r\nSet-Cookie: dropflow=planted\r\n"
    assert browser.post("tokens", json={"name": name}).status_code == 422
    assert browser.patch("account", json={"name": name}).status_code == 422
    account = {"name": "Eve", "email": "eve@x\r\nBcc: all@x", "password": PASSWORD}
    assert browser.post("invitations/accept", json={"secret": "s", "account": account}).status_code == 422


def test_the_host_that_a_request_names_goes_into_no_link(lab: Lab) -> None:
    group = lab.group("Foams")
    browser = lab.browser(lab.person("Ada", {group: Right.MANAGE}))
    made = browser.post(f"groups/{group}/invitations", json={}, headers={"Host": "evil.example"})
    assert made.json()["link"].startswith(ADDRESS)


SCRIPT = "<script>alert(1)</script><img src=x onerror=alert(1)>"


def test_stored_script_comes_back_as_the_text_it_is_and_never_as_a_page(lab: Lab) -> None:
    group = lab.group(SCRIPT)
    browser = lab.browser(lab.person(SCRIPT[:20], {group: Right.MANAGE}))
    document = EXPERIMENT | {"name": SCRIPT, "notes": SCRIPT, "tags": [SCRIPT]}
    made = browser.post("experiments", json={"experiment": document, "group_id": str(group)})
    assert made.json()["experiment"]["name"] == SCRIPT
    for path in (f"experiments/{made.json()['id']}", "experiments", "groups", "session", "account"):
        answer = browser.get(path)
        assert answer.headers["content-type"].startswith("application/json")
        assert answer.headers["x-content-type-options"] == "nosniff"
    missing = browser.get(f"experiments/{SCRIPT}")
    assert missing.headers["content-type"].startswith("application/problem+json")


@pytest.fixture
def strict(settings: Settings, tmp_path: Path) -> Iterator[tuple[Lab, Valkey]]:
    """A service that lets nobody try often, with a queue of its own that can be ended."""
    with running_valkey() as valkey:
        given = lab_settings(settings, redis_url=valkey.url(0), sign_ins_per_minute=3)
        with open_lab(given) as lab:
            yield lab, valkey


def test_guessing_is_refused_soon_also_after_the_counts_were_lost(strict: tuple[Lab, Valkey]) -> None:
    lab, valkey = strict
    said = {"email": "ada@dropflow.test", "password": "guessed"}
    codes = [lab.nobody().post("session", json=said).status_code for _ in range(5)]
    assert codes == [401, 401, 401, 429, 429]
    with redis.Redis.from_url(valkey.url(0)) as counts:
        counts.flushall()
    refused = [lab.nobody().post("session", json=said) for _ in range(5)]
    assert [answer.status_code for answer in refused] == [401, 401, 401, 429, 429]
    assert refused[-1].headers["retry-after"] == "60"
