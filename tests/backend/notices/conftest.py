"""A service that may send notices to this machine, and those who take them."""

from collections.abc import Iterator
from uuid import UUID

import httpx
import pytest

from backend.models import Notice, Right
from tests.houses import SettingsOf
from tests.lab import Lab, lab_settings, open_lab
from tests.receiver import MailServer, Receiver, running_mail_server, running_receiver

HERE = ("127.0.0.0/8",)


@pytest.fixture(scope="module")
def open_door(settings_of: SettingsOf) -> Iterator[Lab]:
    """A service that may send to this machine."""
    with settings_of("door", 5) as settings, open_lab(lab_settings(settings, outward_networks=HERE)) as opened:
        yield opened


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as running:
        yield running


@pytest.fixture
def mailbox() -> Iterator[MailServer]:
    with running_mail_server() as running:
        yield running


@pytest.fixture
def group(open_door: Lab) -> UUID:
    with open_door.house.context.sessions.begin() as session:
        session.query(Notice).delete()
    return open_door.group("Foams")


@pytest.fixture
def ada(open_door: Lab, group: UUID) -> UUID:
    return open_door.person("Ada", {group: Right.MANAGE})


@pytest.fixture
def browser(open_door: Lab, ada: UUID) -> httpx.Client:
    return open_door.browser(ada)
