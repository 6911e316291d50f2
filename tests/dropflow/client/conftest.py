"""A film on disk, a configuration of the test's own, and commands run as people run them."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml

from dropflow.client import Client
from tests.films import EXPERIMENT, PARAMETERS, film
from tests.services import RunningService

Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def stack(tmp_path: Path) -> Path:
    """A folder of frames with an experiment.yaml beside it, called after the test so that each is a film of its own."""
    folder = tmp_path / "film"
    for file in film():
        path = folder / file.name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.content)
    (folder / "experiment.yaml").write_text(yaml.safe_dump(EXPERIMENT | {"name": f"film of {tmp_path.name}"}))
    (folder / "parameters.yaml").write_text(yaml.safe_dump(PARAMETERS))
    return folder / "frames"


@pytest.fixture
def client(service: RunningService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Client]:
    monkeypatch.setenv("DROPFLOW_CONFIG", str(tmp_path / "servers.yaml"))
    with Client(service.url) as client:
        yield client


@pytest.fixture
def command(tmp_path: Path) -> Command:
    """Run `dropflow` with a configuration of the test's own."""

    def run(*arguments: object, said: str = "", **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [Path(sys.executable).with_name("dropflow"), *map(str, arguments)],
            env={**os.environ, "DROPFLOW_CONFIG": str(tmp_path / "servers.yaml"), **variables},
            input=said,
            capture_output=True,
            text=True,
            timeout=200,
        )

    return run
