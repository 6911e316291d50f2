"""Settings that make no sense are refused before anything starts."""

from typing import Any

import pytest
from pydantic import ValidationError

from backend.platform.settings import Settings

GOOD: dict[str, Any] = {
    "database_url": "postgresql://app:p%40ss@127.0.0.1:5432/dropflow",
    "redis_url": "redis://127.0.0.1:6379/0",
    "object_store_url": "file:///var/lib/dropflow",
}


def test_good_settings_are_taken_and_the_driver_is_ours() -> None:
    assert Settings(**GOOD).database_url == "postgresql+psycopg://app:p%40ss@127.0.0.1:5432/dropflow"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"database_url": "mysql://a@b/c"}, "must be a postgresql:// URL"),
        ({"database_url": "nonsense"}, "must be a URL"),
        ({"redis_url": "http://127.0.0.1"}, "must be a redis://"),
        ({"object_store_url": "relative/folder"}, "must be file:///"),
        ({"object_store_url": "memory:///"}, "must be file:///"),
        ({"host": "0.0.0.0"}, "must be a loopback address"),  # noqa: S104 - that is what is refused
        ({"host": "192.168.1.5"}, "must be a loopback address"),
        ({"port": 70_000}, "less than or equal to 65535"),
        ({"max_file_bytes": 2_000, "max_stack_bytes": 1_000}, "must not be larger"),
        ({"lease_s": 0}, "greater than or equal to 1"),
        ({"auth": "none"}, "'local'"),
    ],
)
def test_nonsense_is_refused_by_name(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Settings(**(GOOD | changes))


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1", "127.8.8.8"])
def test_loopback_has_many_names(host: str) -> None:
    assert Settings(**GOOD, host=host).host == host
