"""One service for all tests, emptied before each; or one of processes, in which something is broken."""

from collections.abc import Iterator

import pytest

from tests.faults import Deployment, deployment
from tests.houses import house, kept_house, settings, settings_of, shared_house

__all__ = ["house", "kept_house", "settings", "settings_of", "shared_house"]


@pytest.fixture(scope="package")
def place() -> Iterator[Deployment]:
    with deployment() as running:
        yield running
