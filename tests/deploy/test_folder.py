"""One instance a folder, and passwords that only its owner reads."""

import stat
from pathlib import Path

import pytest

from deploy.local.errors import LauncherError
from deploy.local.folder import open_folder
from deploy.local.options import Options, read_options


def test_a_second_instance_on_a_folder_is_told_where_the_first_is(tmp_path: Path) -> None:
    first, second = (open_folder(Options(port=port, data=tmp_path)) for port in (8123, 8124))
    with first, pytest.raises(LauncherError, match=r"already runs on .* at http://127\.0\.0\.1:8123/\.") as refused:
        second.__enter__()
    assert refused.value.exit_code == 2


def test_a_folder_is_free_again_after_its_instance(tmp_path: Path) -> None:
    for _ in range(2):
        with open_folder(Options(data=tmp_path)) as folder:
            assert folder.objects.is_dir()


def test_passwords_are_made_once_and_readable_by_their_owner_alone(tmp_path: Path) -> None:
    with open_folder(Options(data=tmp_path)) as folder:
        passwords = [folder.password(server) for server in ("postgres", "valkey", "postgres")]
    assert passwords[0] == passwords[2] != passwords[1]
    assert stat.S_IMODE((tmp_path / "keys.json").stat().st_mode) == 0o600


def test_a_folder_that_cannot_be_made_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    context = open_folder(Options(data=tmp_path / "file" / "data"))
    with pytest.raises(LauncherError, match=r"DATA=.*file/data cannot be used: Not a directory") as refused:
        context.__enter__()
    assert refused.value.exit_code == 2


@pytest.mark.parametrize("text", ["http", "0", "65536", "-1", "80.5", "²"])
def test_a_port_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(LauncherError, match=r"PORT is .*; it must be a number from 1 to 65535") as refused:
        read_options({"PORT": text})
    assert refused.value.exit_code == 2


def test_options_come_from_the_environment_and_an_empty_one_counts_as_absent() -> None:
    options = read_options({"PORT": "", "DATA": "here", "REDIS_URL": "redis://h:1/0", "DATABASE_URL": "", "DEMO": "0"})
    assert options == Options(port=8000, data=Path.cwd() / "here", redis_url="redis://h:1/0", has_demo=False)
    assert options.address == "http://127.0.0.1:8000/"
