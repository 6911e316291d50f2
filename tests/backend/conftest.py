"""One service for all tests, emptied before each; and one with accounts."""

from collections.abc import Iterator

import pytest

from tests.houses import SettingsOf, house, kept_house, settings, settings_of, shared_house
from tests.lab import Lab, lab_settings, open_lab

__all__ = ["house", "kept_house", "settings", "settings_of", "shared_house"]


@pytest.fixture(scope="package")
def lab(settings_of: SettingsOf) -> Iterator[Lab]:
    """A service with accounts. It is not emptied: each test makes people and groups of its own."""
    with settings_of("lab", 3) as settings, open_lab(lab_settings(settings)) as opened:
        yield opened
