"""What the composition promises of every container, read from the file itself."""

import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.services import ROOT

COMPOSE = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
ONE_SHOT = {"prepare", "migrate", "backup"}
AS_ROOT = {"prepare", "backup"}


@pytest.mark.parametrize("name", SERVICES)
def test_every_container_is_closed(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in service["security_opt"]
    if name not in AS_ROOT:
        assert not str(service.get("user", "dropflow")).startswith(("0", "root"))


@pytest.mark.parametrize("name", sorted(SERVICES.keys() - ONE_SHOT))
def test_every_server_is_watched_limited_and_comes_back(name: str) -> None:
    service = SERVICES[name]
    assert service["restart"] == "unless-stopped"
    assert service["deploy"]["resources"]["limits"]["memory"]
    # The door is up when what is behind it is; a reconciler is idle most of the time and dies when it cannot work.
    assert name in {"proxy", "reconciler"} or service["healthcheck"]["test"]


@pytest.mark.parametrize("name", [name for name in SERVICES if name.startswith("worker-")])
def test_a_worker_is_asked_by_the_name_that_it_has(name: str) -> None:
    command, check = SERVICES[name]["command"], SERVICES[name]["healthcheck"]["test"]
    queue = command[command.index("--queues") + 1]
    assert command[command.index("--hostname") + 1] == f"{queue}@%h"
    assert check == ["CMD", "/entrypoint", "python", "-m", "worker.alive", queue]


@pytest.mark.parametrize("name", SERVICES)
def test_versions_are_pinned_and_no_secret_stands_in_the_environment(name: str) -> None:
    service = SERVICES[name]
    image = service["image"]
    assert ":" in image
    assert not image.endswith(":latest")
    for variable, value in service.get("environment", {}).items():
        assert "PASSWORD" not in variable or variable.endswith("_FILE"), (variable, value)


def test_only_the_door_is_published_and_by_default_to_this_machine_alone() -> None:
    published = {name: service["ports"] for name, service in SERVICES.items() if "ports" in service}
    assert set(published) == {"proxy"}
    assert all(port.startswith("${BIND:-127.0.0.1}:") for port in published["proxy"])


def test_a_backup_keeps_secrets_and_settings_where_the_guide_looks_for_them() -> None:
    backup = SERVICES["backup"]
    kept = {part.removeprefix("--configuration=") for part in backup["command"] if part.startswith("--configuration=")}
    mounted = {volume.split(":")[1] for volume in backup["volumes"] if volume.endswith(":ro")}
    assert kept == mounted
    guide = (ROOT / "docs" / "how-to" / "lab-server.md").read_text()
    assert all(f"NEWEST/configuration/{Path(path).name}" in guide for path in kept)


def test_secrets_are_made_once_and_stay(tmp_path: Path) -> None:
    def make() -> dict[str, str]:
        subprocess.run([ROOT / "deploy" / "compose-secrets", tmp_path / "secrets"], check=True, capture_output=True)
        return {file.name: file.read_text() for file in (tmp_path / "secrets").iterdir()}

    first = make()
    assert set(first) == set(COMPOSE["secrets"])
    assert first["POSTGRES_PASSWORD"] in first["DATABASE_URL"]
    assert len({first[name] for name in first}) == len(first)
    # That of somebody's mail server is theirs to write; all others are made.
    assert first["SMTP_PASSWORD"] == ""
    assert all(len(value) >= 48 for name, value in first.items() if name != "SMTP_PASSWORD")
    assert make() == first
    assert (tmp_path / "secrets").stat().st_mode & 0o066 == 0


def test_secret_files_become_settings_of_the_process_alone(tmp_path: Path) -> None:
    entrypoint = (ROOT / "deploy" / "images" / "entrypoint").read_text().replace("/run/secrets", str(tmp_path))
    (tmp_path / "SECRET").write_text("with 'quotes' and $signs")
    done = subprocess.run(
        ["sh", "-c", entrypoint, "entrypoint", "printenv", "SECRET"], capture_output=True, text=True, check=True
    )
    assert done.stdout == "with 'quotes' and $signs\n"
