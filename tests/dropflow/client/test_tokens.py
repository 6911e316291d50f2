"""Two groups on one server, and programs with tokens."""

import stat
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from uuid import UUID

import pytest
import yaml

from backend.models import Right, Scope
from dropflow.client import Client, ServerProblem
from tests.dropflow.client.conftest import Command
from tests.house import house_settings
from tests.lab import Lab, lab_settings, open_lab


@pytest.fixture
def lab(database_url: str, redis_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Lab]:
    monkeypatch.setenv("DROPFLOW_CONFIG", str(tmp_path / "servers.yaml"))
    with open_lab(lab_settings(house_settings(database_url, redis_url, tmp_path / "house"))) as opened:
        yield opened


def _address(lab: Lab) -> str:
    return str(lab.house.api.base_url).removesuffix("api/v1/")


def _token(lab: Lab, person: UUID, scope: Scope = Scope.SUBMIT, **about: timedelta) -> str:
    return lab.program(person, scope, **about).headers["Authorization"].removeprefix("Bearer ")


def test_a_script_submits_to_two_groups_and_neither_sees_the_other_s(lab: Lab, stack: Path) -> None:
    foams, emulsions = lab.group("Foams"), lab.group("Emulsions")
    ada = lab.person("Ada", {foams: Right.EDIT, emulsions: Right.EDIT})
    readers = {foams: lab.person("Fay", {foams: Right.VIEW}), emulsions: lab.person("Emil", {emulsions: Right.VIEW})}
    with Client(_address(lab), _token(lab, ada)) as client:
        names = {group.name: group.id for group in client.groups()}
        made = {}
        for group in (foams, emulsions):
            experiment = client.experiments.create(stack.parent / "experiment.yaml", group_id=group)
            made[group] = experiment.upload(stack, beside=stack.parent).id
            lab.house.work()
            assert experiment.wait_ready(timeout_s=60).start().state == "queued"
    assert names["Foams"] == foams
    for group, reader in readers.items():
        with Client(_address(lab), _token(lab, reader, Scope.READ)) as client:
            assert [found.id for found in client.experiments.list()] == [made[group]]
            assert [run.document.experiment_id for run in client.runs.list()] == [made[group]]


def test_a_token_that_is_wrong_expired_or_too_small_is_told(lab: Lab, stack: Path) -> None:
    foams = lab.group("Foams")
    ada = lab.person("Ada", {foams: Right.EDIT})
    for token in (None, "wrong", _token(lab, ada, lasts=timedelta(seconds=-1))):
        with Client(_address(lab), token) as client, pytest.raises(ServerProblem) as raised:
            list(client.experiments.list())
        assert raised.value.status == 401
    with Client(_address(lab), _token(lab, ada, Scope.READ)) as client, pytest.raises(ServerProblem) as raised:
        client.experiments.create(stack.parent / "experiment.yaml", group_id=foams)
    assert (raised.value.status, raised.value.code) == (403, "forbidden.scope")


def test_login_takes_a_token_that_lets_in_and_no_other(lab: Lab, command: Command, stack: Path, tmp_path: Path) -> None:
    foams = lab.group("Foams")
    token = _token(lab, lab.person("Ada", {foams: Right.EDIT}))
    for wrong in (command("login", _address(lab)), command("login", _address(lab), DROPFLOW_TOKEN="wrong")):  # noqa: S106
        assert wrong.returncode == 2
        assert "[client.wrong_token]" in wrong.stderr
    assert not (tmp_path / "servers.yaml").exists()
    right = command("login", _address(lab), said=f"{token}\n")
    assert right.returncode == 0, right.stderr
    assert token not in right.stdout + right.stderr
    assert stat.S_IMODE((tmp_path / "servers.yaml").stat().st_mode) == 0o600
    assert yaml.safe_load((tmp_path / "servers.yaml").read_text())["servers"] == [
        {"url": _address(lab), "token": token}
    ]
    elsewhere = command("submit", stack, "--experiment", stack.parent / "experiment.yaml", "--group", "Soaps")
    assert elsewhere.returncode == 2
    assert "There is no group Soaps" in elsewhere.stderr
    assert "Foams" in elsewhere.stderr
    assert command("status").returncode == 0
