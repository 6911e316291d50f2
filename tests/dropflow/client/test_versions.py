"""Servers of other versions."""

import pytest

from backend.health.endpoints import API_VERSION
from dropflow.client.errors import WrongVersion
from dropflow.client.versions import FIRST, ApiVersion, Capability, check, read_version


def test_a_server_that_says_no_version_is_of_the_first() -> None:
    assert read_version(None) == FIRST == ApiVersion(1, 0)


def test_a_newer_minor_version_is_understood() -> None:
    assert read_version("1.99") > FIRST


@pytest.mark.parametrize("text", ["2.0", "0.9", "1", "one", "", "1.x", "-1.0"])
def test_another_major_version_is_refused_with_what_to_do(text: str) -> None:
    with pytest.raises(WrongVersion, match="speaks version"):
        read_version(text)


def test_what_a_server_is_too_old_for_is_said() -> None:
    with pytest.raises(WrongVersion, match=r"version 1\.0 of the API; the list of all runs came with 1\.1"):
        check(FIRST, Capability.ALL_RUNS)


def test_this_client_asks_for_nothing_that_this_service_is_too_old_for() -> None:
    assert all(capability.since <= read_version(API_VERSION) for capability in Capability)
