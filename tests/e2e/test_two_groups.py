"""Two groups on one server: each in a browser of its own sees what is theirs, and a script submits to both."""

from collections.abc import Iterator

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
from tests.services import RunningService, database, running_service

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

ACCOUNTS = {"AUTH": "accounts", "SECRET": "not a secret: it stands in the tests", "PUBLIC_URL": "http://127.0.0.1/"}
PASSWORD = "correct horse battery staple"  # noqa: S105


@pytest.fixture
def server(postgres_server: Postgres, migrated_template: str, valkey_server: Valkey) -> Iterator[RunningService]:
    with (
        database(postgres_server, template=migrated_template) as url,
        running_service(url, valkey_server.url(4), **ACCOUNTS) as running,
    ):
        yield running


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


def test_two_groups_work_on_one_server_and_neither_sees_the_other(server: RunningService) -> None:
    with open_page(server.url) as ada:
        ada.goto(way_in(server))
        expect(ada.get_by_role("button", name="Ada")).to_be_visible()
        invitation = make_group(ada, "Foams").replace(ACCOUNTS["PUBLIC_URL"], server.url)
        assert serious_findings(ada) == []

        browser = ada.context.browser
        assert browser is not None
        grace = browser.new_context(base_url=server.url, viewport={"width": 1280, "height": 900}).new_page()
        grace.goto(server.url)
        expect(grace.get_by_role("heading", name="Sign in")).to_be_visible()
        assert serious_findings(grace) == []
        admin = browser.new_context(base_url=server.url).new_page()
        admin.goto(way_in(server))
        emulsions = make_group(admin, "Emulsions").replace(ACCOUNTS["PUBLIC_URL"], server.url)
        grace.goto(emulsions)
        expect(grace.get_by_role("heading", name="Join Emulsions")).to_be_visible()
        grace.get_by_label("Name").fill("Grace")
        grace.get_by_label("E-mail").fill("grace@dropflow.test")
        grace.get_by_label("Password", exact=True).fill(PASSWORD)
        grace.get_by_role("button", name="Make an account and join").click()
        expect(grace.get_by_role("button", name="Grace")).to_be_visible()

        submit(server, make_token(ada, "script"), "Foams", "a foam")
        submit(server, make_token(grace, "script"), "Emulsions", "an emulsion")
        assert serious_findings(grace) == []
        grace.goto(server.url)
        expect(grace.get_by_text("an emulsion")).to_be_visible()
        expect(grace.get_by_text("a foam")).to_have_count(0)
        ada.goto(server.url)
        expect(ada.get_by_text("a foam")).to_be_visible()
        ada.goto("administration")
        expect(ada.get_by_role("heading", name="Administration")).to_be_visible()
        expect(ada.get_by_text("grace@dropflow.test")).to_be_visible()
        assert serious_findings(ada) == []
        assert invitation != emulsions

        grace.get_by_role("button", name="Grace").click()
        grace.get_by_role("menuitem", name="Sign out").click()
        grace.get_by_label("E-mail").fill("grace@dropflow.test")
        grace.get_by_label("Password", exact=True).fill(PASSWORD)
        grace.get_by_role("button", name="Sign in").click()
        expect(grace.get_by_text("an emulsion")).to_be_visible()
