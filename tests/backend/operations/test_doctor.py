"""The doctor finds a whole service good, and says of a broken part what to mend."""

import json
import os
import secrets
import subprocess
from pathlib import Path

import psycopg
import pytest

from backend.operations.doctor import CONNECTIONS_OF_API, CONNECTIONS_OF_OTHERS, Verdict, examine
from backend.platform.settings import Settings, with_driver
from deploy.local.postgres import Postgres, new_password, plain
from tests.services import ROOT, RunningService, scratch_folder

COMMAND = ROOT / "deploy" / "bin" / "dropflow-server"


def asked(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [COMMAND, *arguments], env={**os.environ, **environment}, capture_output=True, text=True, timeout=60
    )


def test_a_running_service_is_good_in_every_part(service: RunningService) -> None:
    done = asked("doctor", "--json", **service.environment)
    findings = {found["part"]: found for found in map(json.loads, done.stdout.splitlines())}
    page = findings.pop("page")
    assert {found["verdict"] for found in findings.values()} <= {"good", "doubtful"}, findings
    assert set(findings) == {"database", "connections", "clock", "queue", "workers", "work", "object store", "disks"}
    assert done.returncode == int(page["verdict"] == "bad")


def test_parts_that_are_away_are_named_with_what_to_do(settings: Settings, tmp_path: Path) -> None:
    broken = settings.model_copy(
        update={
            "redis_url": "redis://127.0.0.1:1/0",
            "database_url": settings.database_url.replace("test_", "gone_"),
            "frontend_dist": tmp_path / "nowhere",
        }
    )
    findings = {finding.part: finding for finding in examine(broken)}
    assert findings["object store"].verdict == Verdict.GOOD
    for part in ("database", "queue", "workers", "page"):
        assert findings[part].verdict == Verdict.BAD
        assert findings[part].mend


def test_an_old_form_of_the_database_is_told_with_the_command_that_helps(
    settings: Settings, empty_database_url: str
) -> None:
    old = Settings(**settings.model_dump() | {"database_url": empty_database_url})
    database, *_others = examine(old)
    assert database.verdict == Verdict.BAD
    assert "dropflow-server migrate" in database.mend


def test_a_database_that_keeps_bytes_instead_of_text_is_bad(settings: Settings, postgres_server: Postgres) -> None:
    name = f"ascii_{secrets.token_hex(4)}"
    make = f"CREATE DATABASE {name} ENCODING 'SQL_ASCII' LC_COLLATE 'C' LC_CTYPE 'C' TEMPLATE template0"
    with psycopg.connect(plain(postgres_server.url()), autocommit=True) as connection:
        connection.execute(make)
    try:
        found, *_others = examine(settings.model_copy(update={"database_url": with_driver(postgres_server.url(name))}))
    finally:
        postgres_server.drop_database(name)
    assert found.verdict == Verdict.BAD
    assert "SQL_ASCII" in found.found
    assert "UTF8" in found.mend


def test_a_server_that_lets_too_few_in_is_told_with_how_many_would_do(settings: Settings) -> None:
    with scratch_folder() as folder:
        server = Postgres(folder, password=new_password(), log=folder / "log", is_durable=False, max_connections=25)
        child = server.start()
        try:
            url = with_driver(server.url())
            findings = {found.part: found for found in examine(settings.model_copy(update={"database_url": url}))}
        finally:
            child.stop()
    assert findings["connections"].verdict == Verdict.DOUBTFUL
    assert f"{CONNECTIONS_OF_API + CONNECTIONS_OF_OTHERS} or more" in findings["connections"].mend


@pytest.mark.parametrize(
    ("environment", "said"),
    [
        ({"DATABASE_URL": ""}, "DATABASE_URL"),
        ({"DATABASE_URL": "mysql://x/y", "REDIS_URL": "redis://x"}, "DATABASE_URL"),
    ],
)
def test_wrong_settings_are_one_line_and_exit_code_2(environment: dict[str, str], said: str) -> None:
    done = asked("doctor", **{"REDIS_URL": "redis://x", "OBJECT_STORE_URL": "file:///tmp/x"} | environment)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
