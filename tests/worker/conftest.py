"""One service for all tests, emptied before each; or one of its own settings, for a test that makes it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from backend.platform.settings import Settings
from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.faults import Deployment, deployment
from tests.house import House, house_settings, open_house
from tests.services import database


@pytest.fixture
def settings(database_url: str, redis_url: str, tmp_path: Path) -> Settings:
    return house_settings(database_url, redis_url, tmp_path)


@pytest.fixture(scope="package")
def kept_house(
    postgres_server: Postgres,
    migrated_template: str,
    valkey_server: Valkey,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[House]:
    with database(postgres_server, template=migrated_template) as url:
        settings = house_settings(url, valkey_server.url(2), tmp_path_factory.mktemp("house"))
        with open_house(settings) as house:
            yield house


@pytest.fixture(scope="package")
def place() -> Iterator[Deployment]:
    with deployment() as running:
        yield running


@pytest.fixture
def house(kept_house: House) -> House:
    kept_house.empty()
    return kept_house


@pytest.fixture(scope="module")
def shared_house(kept_house: House) -> House:
    """Emptied once a module: its tests look at what one of them made."""
    kept_house.empty()
    return kept_house
