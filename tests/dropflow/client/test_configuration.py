"""Which server, and with which token."""

import stat
from pathlib import Path

import pytest

from dropflow.client.configuration import Server, checked_url, configuration_file, find_server, forget, remember
from dropflow.client.errors import NotConfigured

URL = "https://dropflow.lab.example/"


@pytest.fixture(autouse=True)
def own_configuration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("DROPFLOW_SERVER", "DROPFLOW_TOKEN", "DROPFLOW_CONFIG"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setattr("sys.platform", "linux")
    return tmp_path / "config" / "dropflow" / "servers.yaml"


def test_what_is_remembered_is_found_and_is_for_nobody_else_to_read(own_configuration: Path) -> None:
    assert remember(Server(URL, "secret")) == own_configuration == configuration_file()
    assert stat.S_IMODE(own_configuration.stat().st_mode) == 0o600
    assert find_server() == Server(URL, "secret")
    remember(Server(URL, "newer"))
    assert stat.S_IMODE(own_configuration.stat().st_mode) == 0o600
    assert find_server().token == "newer"  # noqa: S105 - no secret


def test_the_last_login_is_the_server_and_others_keep_their_tokens() -> None:
    remember(Server(URL, "one"))
    remember(Server("http://127.0.0.1:8000/"))
    assert find_server() == Server("http://127.0.0.1:8000/", None)
    assert find_server("dropflow.lab.example") == Server("http://dropflow.lab.example/", None)
    assert find_server(f"{URL}api/v1/") == Server(URL, "one")
    assert forget(URL)
    assert not forget(URL)
    assert find_server(URL).token is None


def test_a_token_goes_to_no_other_server(monkeypatch: pytest.MonkeyPatch) -> None:
    remember(Server(URL, "one"))
    assert find_server("https://elsewhere.example/").token is None


def test_the_environment_comes_before_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    remember(Server(URL, "one"))
    monkeypatch.setenv("DROPFLOW_SERVER", "http://127.0.0.1:1/")
    monkeypatch.setenv("DROPFLOW_TOKEN", "from the environment")
    assert find_server() == Server("http://127.0.0.1:1/", "from the environment")


def test_without_a_server_it_says_what_to_do() -> None:
    with pytest.raises(NotConfigured, match="dropflow login"):
        find_server()


@pytest.mark.parametrize("content", ["[", "servers: 1", "x", "- 1", "\xff\xfe"])
def test_a_file_that_is_none_is_said_to_be_none(own_configuration: Path, content: str) -> None:
    own_configuration.parent.mkdir(parents=True)
    own_configuration.write_bytes(content.encode("latin-1"))
    with pytest.raises(NotConfigured, match=r"servers\.yaml"):
        find_server()


@pytest.mark.parametrize("url", ["", "ftp://x/", "http://", "https://me:secret@x/", "http://x/?a=1", "http://x:99999/"])
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(NotConfigured, match="no address"):
        checked_url(url)


def test_a_token_is_not_printed() -> None:
    assert "secret" not in repr(Server(URL, "secret"))
