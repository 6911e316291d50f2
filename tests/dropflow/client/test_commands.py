"""`dropflow login`, `submit`, `status`, `fetch` and `compare`, run as people run them."""

import json
import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from dropflow.results import open_results
from tests.dropflow.client.conftest import Command
from tests.services import RunningService, running_service


def _id_of(said: str) -> str:
    return next(word for word in said.split() if len(word) == 36 and word.count("-") == 4)


def test_from_login_to_numbers_side_by_side(
    service: RunningService, command: Command, stack: Path, tmp_path: Path
) -> None:
    about = ("--experiment", stack.parent / "experiment.yaml", "--parameters", stack.parent / "parameters.yaml")
    logged_in = command("login", service.url)
    assert (logged_in.returncode, logged_in.stderr) == (0, "")
    assert stat.S_IMODE((tmp_path / "servers.yaml").stat().st_mode) == 0o600
    submitted = command("submit", stack, *about, "--wait", "--output", tmp_path / "results")
    assert submitted.returncode == 0, submitted.stderr
    assert "upload, MB: 1 of 1" in submitted.stderr
    assert "track: 6 of 6" in submitted.stderr
    run = _id_of(submitted.stdout)
    again = command("submit", stack, *about)
    assert again.stdout.startswith(f"The run was there already: {run}")
    assert open_results(tmp_path / "results").n_frames == 6
    told = command("status", run)
    assert told.returncode == 0
    assert "completed" in told.stdout
    assert "analyse    completed  6/6" in told.stdout
    listed = command("status", "--state", "completed", "--json")
    assert run in [json.loads(line)["id"] for line in listed.stdout.splitlines()]
    fetched = command("fetch", f"{service.url}runs/{run}", "--output", tmp_path / "fetched")
    assert fetched.returncode == 0, fetched.stderr
    assert open_results(tmp_path / "fetched").summary == open_results(tmp_path / "results").summary
    same = command("compare", run, tmp_path / "fetched")
    assert same.stdout == "They are the same in all numbers and parameters.\n"
    (stack.parent / "parameters.yaml").write_text(
        "detection: {method: paper, radius_min_um: 7.0, radius_max_um: 20.0}\ntracking: {method: paper}\n"
    )
    other = _id_of(command("submit", stack, *about, "--wait").stdout)
    compared = command("compare", run, other)
    assert "detected.n_droplets" in compared.stdout
    assert "provenance.parameters.detection.radius_min_um" in compared.stdout
    assert "provenance.input_sha256" not in compared.stdout
    assert command("compare", "--csv", run, other).stdout.splitlines()[0] == f",{run},{other}"


@pytest.mark.parametrize("kill_after_s", [0.6, 1.2, 2.0])
def test_a_killed_submit_goes_on_and_makes_no_double(
    service: RunningService, command: Command, stack: Path, tmp_path: Path, kill_after_s: float
) -> None:
    arguments = ("submit", stack, "--experiment", stack.parent / "experiment.yaml", "--server", service.url)
    killed = subprocess.Popen(
        [Path(sys.executable).with_name("dropflow"), *map(str, arguments)],
        env=os.environ | {"DROPFLOW_CONFIG": str(tmp_path / "servers.yaml")},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    time.sleep(kill_after_s)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    done = command(*arguments)
    assert done.returncode == 0, done.stderr
    with httpx.Client(base_url=f"{service.url}api/v1/") as api:
        (experiment,) = api.get("experiments", params={"q": f"film of {tmp_path.name}"}).json()["items"]
        assert experiment["n_runs"] == 1
        assert experiment["stack"]["n_frames"] == 6
        assert api.post(f"runs/{_id_of(done.stdout)}/cancel").status_code in (202, 409)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["status"], "client.not_configured"),
        (["status", "--server", "http://127.0.0.1:1/"], "client.not_reachable"),
        (["status", "--server", "ftp://x"], "client.not_configured"),
        (["status", "--server", "SERVER", "00000000-0000-4000-8000-00000000dead"], "not_found.run"),
        (["status", "--server", "SERVER", "no id"], "client.no_id"),
        (["status", "--server", "SERVER", "--state", "lost"], "request.invalid"),
        (["fetch", "--server", "SERVER", "x", "-o", "y"], "client.no_id"),
        (["compare", "one"], "compare.one_run"),
        (["submit", "nothing", "--experiment", "nothing.yaml", "--server", "SERVER"], "experiment.invalid"),
        (["login", "http://127.0.0.1:1/"], "client.not_reachable"),
    ],
)
def test_what_is_wrong_is_one_line_and_exit_code_2(
    service: RunningService, command: Command, arguments: list[str], words: str
) -> None:
    done = command(*(service.url if word == "SERVER" else word for word in arguments))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert f"[{words}]" in done.stderr


@pytest.mark.slow
def test_frames_that_the_server_can_read_are_imported_and_nothing_is_sent(
    database_url: str, redis_url: str, command: Command, stack: Path
) -> None:
    roots = json.dumps({"microscope": stack.parent.as_uri()})
    about = ("--experiment", stack.parent / "experiment.yaml", "--parameters", stack.parent / "parameters.yaml")
    with running_service(database_url, redis_url, IMPORT_ROOTS=roots) as service:
        asked = ("submit", "frames", *about, "--import-from", "microscope", "--by-reference", "--server", service.url)
        done = command(*asked, "--wait")
        assert done.returncode == 0, done.stderr
        assert "upload" not in done.stderr
        assert command(*asked).stdout.startswith(f"The run was there already: {_id_of(done.stdout)}")
        elsewhere = ("submit", "../frames", *about, "--import-from", "microscope", "--server", service.url)
        refused = command(*elsewhere)
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1), refused.stderr
