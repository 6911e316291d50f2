"""Two groups on one server: each in a browser of its own sees what is theirs, and a script submits to both."""

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect

from backend.people.administrator import administrator
from backend.platform.database import make_engine, make_sessions
from backend.platform.settings import Settings
from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.e2e.browser import open_page, serious_findings
from tests.films import EXPERIMENT
from tests.receiver import Receiver, running_receiver
from tests.services import RunningService, database, running_service

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

ACCOUNTS = {"AUTH": "accounts", "SECRET": "not a secret: it stands in the tests", "PUBLIC_URL": "http://127.0.0.1/"}
INSIDE = {"OUTWARD_NETWORKS": '["127.0.0.0/8"]'}
PASSWORD = "correct horse battery staple"  # noqa: S105


@pytest.fixture
def server(postgres_server: Postgres, migrated_template: str, valkey_server: Valkey) -> Iterator[RunningService]:
    with (
        database(postgres_server, template=migrated_template) as url,
        running_service(url, valkey_server.url(4), **ACCOUNTS, **INSIDE) as running,
    ):
        yield running


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as running:
        yield running


@contextmanager
def open_profile(beside: Page, base_url: str) -> Iterator[Page]:
    """Another person's browser, which shares nothing with the one beside it."""
    browser = beside.context.browser
    assert browser is not None
    context = browser.new_context(base_url=base_url, viewport={"width": 1280, "height": 900})
    try:
        yield context.new_page()
    finally:
        context.close()


def way_in(server: RunningService) -> str:
    """The link that `dropflow-server administrator` prints, as this machine reaches the server."""
    names = ("DATABASE_URL", "REDIS_URL", "OBJECT_STORE_URL", *ACCOUNTS)
    settings = Settings.model_validate({name.lower(): server.environment[name] for name in names})
    engine = make_engine(settings.database_url, application="test")
    with make_sessions(engine).begin() as session:
        link = administrator(session, settings, email="ada@dropflow.test", name="Ada")
    engine.dispose()
    return link.replace(ACCOUNTS["PUBLIC_URL"], server.url)


def make_group(page: Page, name: str) -> str:
    """Make a group on the page; the link that invites somebody to it."""
    page.get_by_role("button", name="Ada").click()
    page.get_by_role("menuitem", name="Groups").click()
    page.get_by_role("textbox", name="Name").fill(name)
    page.get_by_role("button", name="Make a group").click()
    expect(page.get_by_role("heading", name=name, level=1)).to_be_visible()
    page.get_by_role("button", name="Make a link").click()
    return page.get_by_role("textbox", name="Invitation").input_value()


def leave_group(page: Page, name: str, *, let: str) -> None:
    """Let another manage a group, and leave it."""
    page.goto("groups")
    page.get_by_role("link", name=name).click()
    right = page.get_by_label(f"What {let} may do").first  # its list of choices has the same label
    right.click()
    page.get_by_role("option", name="manage").click()
    expect(right).to_have_value("manage")
    page.get_by_role("button", name="Leave").click()
    page.get_by_role("button", name="Leave it").click()
    expect(page.get_by_role("dialog")).to_have_count(0)


def make_token(page: Page, name: str) -> str:
    """Make a token to submit with on the account page."""
    page.goto("account")
    panel = page.get_by_role("region", name="Tokens")
    panel.get_by_role("textbox", name="Name").fill(name)
    panel.get_by_role("button", name="Make a token").click()
    return panel.get_by_role("textbox", name=f"Token {name}").input_value()


def submit(server: RunningService, token: str, group: str, name: str) -> None:
    """What a script does: find its group by name, and put an experiment into it."""
    with httpx.Client(base_url=f"{server.url}api/v1/", headers={"Authorization": f"Bearer {token}"}) as script:
        groups = {found["name"]: found["id"] for found in script.get("groups").raise_for_status().json()["items"]}
        document = {"experiment": EXPERIMENT | {"name": name}, "group_id": groups[group]}
        script.post("experiments", json=document).raise_for_status()


def look_over(page: Page, pictures: Path, name: str) -> None:
    """Keep a picture of the page, and see that everybody can use it."""
    expect(page.get_by_role("heading", level=1)).to_be_visible()
    assert serious_findings(page) == []
    page.screenshot(path=pictures / f"{name}.png", full_page=True)


def join(page: Page, invitation: str, group: str) -> None:
    """Make an account on the page of an invitation."""
    page.goto(invitation)
    expect(page.get_by_role("heading", name=f"Join {group}")).to_be_visible()
    page.get_by_label("Name").fill("Grace")
    page.get_by_label("E-mail").fill("grace@dropflow.test")
    page.get_by_label("Password", exact=True).fill(PASSWORD)
    page.get_by_role("button", name="Make an account and join").click()
    expect(page.get_by_role("button", name="Grace")).to_be_visible()


def tell_by_webhook(page: Page, receiver: Receiver) -> None:
    """Add a webhook on the page of a group, and see a test arrive."""
    page.get_by_role("textbox", name="Address").fill(receiver.address)
    page.get_by_role("button", name="Add a webhook").click()
    expect(page.get_by_role("textbox", name="Secret of the webhook")).to_have_value(re.compile("^whsec_"))
    page.get_by_role("button", name="Send a test").click()
    expect(page.get_by_text("delivered")).to_be_visible()
    assert json.loads(receiver.came[0][1])["type"] == "test"


def test_two_groups_work_on_one_server_and_neither_sees_the_other(
    server: RunningService, receiver: Receiver, tmp_path: Path
) -> None:
    with open_page(server.url) as ada, open_profile(ada, server.url) as grace:
        ada.goto(way_in(server))
        expect(ada.get_by_role("button", name="Ada")).to_be_visible()
        make_group(ada, "Foams")
        tell_by_webhook(ada, receiver)
        look_over(ada, tmp_path, "group")
        invitation = make_group(ada, "Emulsions").replace(ACCOUNTS["PUBLIC_URL"], server.url)

        grace.goto(server.url)
        expect(grace.get_by_role("heading", name="Sign in")).to_be_visible()
        assert serious_findings(grace) == []
        join(grace, invitation, "Emulsions")
        leave_group(ada, "Emulsions", let="Grace")

        submit(server, make_token(ada, "script"), "Foams", "a foam")
        submit(server, make_token(grace, "script"), "Emulsions", "an emulsion")
        look_over(grace, tmp_path, "account")
        for page, own, foreign in ((ada, "a foam", "an emulsion"), (grace, "an emulsion", "a foam")):
            page.goto(server.url)
            expect(page.get_by_text(own)).to_be_visible()
            expect(page.get_by_text(foreign)).to_have_count(0)
        look_over(grace, tmp_path, "experiments")
        ada.goto("administration")
        expect(ada.get_by_text("grace@dropflow.test")).to_be_visible()
        look_over(ada, tmp_path, "administration")

        grace.get_by_role("button", name="Grace").click()
        grace.get_by_role("menuitem", name="Sign out").click()
        grace.get_by_label("E-mail").fill("grace@dropflow.test")
        grace.get_by_label("Password", exact=True).fill(PASSWORD)
        grace.get_by_role("button", name="Sign in").click()
        grace.get_by_text("an emulsion").click()
        grace.get_by_role("button", name="Move").click()
        grace.get_by_label("Group", exact=True).first.click()
        grace.get_by_role("option", name=re.compile("own space")).click()
        look_over(grace, tmp_path, "move")
        grace.get_by_role("button", name="Move it").click()
        expect(grace.get_by_role("dialog")).to_have_count(0)
