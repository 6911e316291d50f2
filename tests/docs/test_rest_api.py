"""What the reference of the REST API tells people to type."""

import re
import shutil
import subprocess
from pathlib import Path

import httpx
import pytest

from tests.films import frame, tiff
from tests.services import ROOT, RunningService

PAGE = ROOT / "docs" / "reference" / "rest-api.md"


def test_four_calls_of_curl_upload_and_run(service: RunningService, tmp_path: Path) -> None:
    if shutil.which("curl") is None:
        pytest.skip("curl is not installed")
    (script,) = re.findall(r"```sh\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    (tmp_path / "film.tif").write_bytes(tiff(*(frame(index) for index in range(4))))
    here = script.replace("http://127.0.0.1:8000/", service.url)
    assert here != script
    token = httpx.post(f"{service.url}api/v1/tokens", json={"name": "curl", "scope": "submit", "days": 1}).json()[
        "secret"
    ]
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", f"{here}\necho\necho $EXPERIMENT"],
        cwd=tmp_path,
        env={"PATH": "/usr/bin:/bin", "DROPFLOW_TOKEN": token, "no_proxy": "127.0.0.1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (run,) = httpx.get(f"{service.url}api/v1/experiments/{done.stdout.split()[-1]}/runs").json()["items"]
    assert run["parameters"]["detection"]["radius_min_um"] == 4.0
    httpx.post(f"{service.url}api/v1/runs/{run['id']}/cancel")
