"""`dropflow compile` leaves compiled code behind, and commands say so where there is none yet."""

import subprocess
import sys
from pathlib import Path

import pytest

from dropflow.cli.compile import say_if_not_compiled

COMMAND = [sys.executable, "-c", "from dropflow.cli import main; main()"]


def test_whoever_waits_is_told_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    say_if_not_compiled()
    assert "compiled for this processor" in capsys.readouterr().err
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "kernel.nbi").touch()
    say_if_not_compiled()
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_nothing_is_left_to_compile_for_a_film(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "compiled"))
    film = tmp_path / "film"
    size = ("--frames", "4", "--height", "300", "--width", "300")
    subprocess.run([*COMMAND, "simulate", film, "--scenario", "dense", *size], check=True)
    subprocess.run([*COMMAND, "compile"], check=True)
    compiled = {path: path.stat().st_mtime_ns for path in (tmp_path / "compiled").rglob("*.nb*")}
    experiment = ("--experiment", film / "experiment.yaml")
    subprocess.run([*COMMAND, "analyse", film / "frames", *experiment, "-o", tmp_path / "results"], check=True)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "compiled").rglob("*.nb*")} == compiled
