"""Fixtures of a service: one for all tests of a folder, emptied before each; or settings, for a house of its own.

A `conftest.py` imports them by name; `settings_of` alone serves a house with other settings.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

from backend.platform.settings import Settings
from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.house import House, house_settings, open_house
from tests.services import database

SettingsOf = Callable[[str, int], AbstractContextManager[Settings]]


@pytest.fixture(scope="session")
def settings_of(
    postgres_server: Postgres,
    migrated_template: str,
    valkey_server: Valkey,
    tmp_path_factory: pytest.TempPathFactory,
) -> SettingsOf:
    """Settings of a service with a database of its own, by the name of its folder and the number of its queues."""

    @contextmanager
    def opened(name: str, queues: int) -> Iterator[Settings]:
        with database(postgres_server, template=migrated_template) as url:
            yield house_settings(url, valkey_server.url(queues), tmp_path_factory.mktemp(name))

    return opened


@pytest.fixture
def settings(database_url: str, redis_url: str, tmp_path: Path) -> Settings:
    return house_settings(database_url, redis_url, tmp_path)


@pytest.fixture(scope="package")
def kept_house(settings_of: SettingsOf) -> Iterator[House]:
    with settings_of("house", 2) as settings, open_house(settings) as house:
        yield house


@pytest.fixture
def house(kept_house: House) -> House:
    kept_house.empty()
    return kept_house


@pytest.fixture(scope="module")
def shared_house(kept_house: House) -> House:
    """Emptied once a module: its tests look at what one of them made."""
    kept_house.empty()
    return kept_house
