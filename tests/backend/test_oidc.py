"""Signing in at a real provider, which runs as a process of its own."""

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from backend.platform.settings import Settings
from deploy.local.processes import free_port
from tests.lab import ADDRESS, Lab, lab_settings, open_lab


@pytest.fixture(scope="module")
def provider() -> Iterator[str]:
    port = free_port()
    # Its own use of deprecated parts of a library is none of our concern.
    command = [sys.executable, "-W", "ignore", "-m", "oidc_provider_mock", "--port", str(port)]
    address = f"http://127.0.0.1:{port}"
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        deadline = time.monotonic() + 60
        while True:
            try:
                httpx.get(f"{address}/.well-known/openid-configuration").raise_for_status()
                break
            except httpx.HTTPError:
                assert process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.1)
        yield address
    finally:
        process.terminate()
        process.wait()


@pytest.fixture
def lab(settings: Settings, tmp_path: Path, provider: str) -> Iterator[Lab]:
    issuer = httpx.get(f"{provider}/.well-known/openid-configuration").json()["issuer"]
    about = {"oidc_issuer": issuer, "oidc_client_id": "dropflow", "oidc_client_secret": "theirs"}
    groups = {"lab-foams": "Foams:edit", "lab-heads": "Foams:manage", "lab-drops": "Drops:view"}
    with open_lab(lab_settings(settings, **about, oidc_groups=groups)) as opened:
        yield opened


def come_back(browser: httpx.Client, provider: str, subject: str, *, go_on: str = "/", **claims: object) -> httpx.URL:
    """Go to the provider, be let in there as `subject`, and come back: the address with which one does."""
    httpx.put(f"{provider}/users/{subject}", json=claims).raise_for_status()
    sent = browser.get("session/oidc", params={"next": go_on})
    assert sent.status_code == 302, sent.text
    let_in = httpx.post(sent.headers["location"], data={"sub": subject})
    assert let_in.status_code == 302, let_in.text
    back = httpx.URL(let_in.headers["location"])
    assert str(back).startswith(f"{ADDRESS}api/v1/session/oidc/callback?")
    return back


def callback(browser: httpx.Client, back: httpx.URL) -> httpx.Response:
    return browser.get("session/oidc/callback", params=dict(back.params))


def rights(browser: httpx.Client) -> dict[str, str]:
    groups = browser.get("session").json()["groups"]
    return {group["name"]: group["right"] for group in groups if not group["is_personal"]}


def test_a_provider_lets_people_in_and_says_in_which_groups_they_are(lab: Lab, provider: str) -> None:
    browser = lab.nobody()
    assert browser.get("session").json()["ways"] == ["password", "oidc"]
    claims = {"email": "Ada@Example.org", "name": "Ada Lovelace", "groups": ["lab-foams", "lab-drops", "elsewhere"]}
    answer = callback(browser, come_back(browser, provider, "ada", go_on="/runs/1?frame=2", **claims))
    assert (answer.status_code, answer.headers["location"]) == (302, f"{ADDRESS}runs/1?frame=2")
    person = browser.get("session").json()["person"]
    assert (person["name"], person["email"], person["is_administrator"]) == ("Ada Lovelace", "ada@example.org", False)
    assert rights(browser) == {"Foams": "edit", "Drops": "view"}

    again = lab.nobody()
    callback(again, come_back(again, provider, "ada", **claims | {"groups": ["lab-foams", "lab-heads"]}))
    assert again.get("session").json()["person"]["id"] == person["id"]
    assert rights(again) == {"Foams": "manage"}, "groups follow the provider, each time"


def test_a_sign_in_that_another_browser_began_lets_nobody_in(lab: Lab, provider: str) -> None:
    attacker, victim = lab.nobody(), lab.nobody()
    back = come_back(attacker, provider, "eve", name="Eve")
    assert callback(victim, back).json()["code"] == "session.oidc"
    come_back(victim, provider, "ada", name="Ada")
    assert callback(victim, back).status_code == 401, "the state is that of another attempt"
    forged = victim.cookies["dropflow_oidc"].partition(".")[0] + ".0000"
    victim.cookies.set("dropflow_oidc", forged)
    assert callback(victim, back).status_code == 401


def test_a_code_works_once(lab: Lab, provider: str) -> None:
    browser = lab.nobody()
    back = come_back(browser, provider, "ada", name="Ada")
    kept = browser.cookies["dropflow_oidc"]
    assert callback(browser, back).status_code == 302
    second = lab.nobody()
    second.cookies.set("dropflow_oidc", kept)
    assert callback(second, back).status_code == 401


def test_an_address_alone_gives_nobody_the_account_of_another(lab: Lab, provider: str) -> None:
    grace = lab.person("Grace", password="correct horse battery")  # noqa: S106
    browser = lab.nobody()
    answer = callback(browser, come_back(browser, provider, "eve", name="Eve", email=lab.email(grace)))
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.email")


@pytest.mark.parametrize("go_on", ["https://evil.example/", "//evil.example", "/\\evil.example", "/a\r\nX: b"])
def test_open_redirect_one_goes_on_here_only(lab: Lab, provider: str, go_on: str) -> None:
    browser = lab.nobody()
    answer = callback(browser, come_back(browser, provider, "ada", go_on=go_on, name="Ada"))
    assert answer.headers["location"] == ADDRESS
