"""Damaged files of every kind: an error with a code or frames, little memory, and the process lives."""

import json
import subprocess
import sys

import pytest

from tests.dropflow.frames.fuzzing import KINDS, SHORT_KINDS

N_SHORT, N_WHOLE = 200, 2000
MAX_GROWN_MB = 600


def fuzz(kind: str, first_seed: int, n: int) -> dict[str, int]:
    """Outcomes of reading `n` damaged files in a process of its own, which must not die of any."""
    command = [sys.executable, "-m", "tests.dropflow.frames.fuzzing", kind, str(first_seed), str(n)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=280)
    said = done.stdout.splitlines()
    assert done.returncode == 0, f"{kind} ended at seed {said[-1:]}: {done.stderr[-3000:]}"
    found = json.loads(said[-1].removeprefix("done "))
    assert found["grown_mb"] < MAX_GROWN_MB
    outcomes: dict[str, int] = found["outcomes"]
    assert sum(outcomes.values()) == n
    return outcomes


@pytest.mark.parametrize("kind", SHORT_KINDS)
def test_no_damaged_file_ends_a_reader(kind: str) -> None:
    outcomes = fuzz(kind, 0, N_SHORT)
    assert sum(n for outcome, n in outcomes.items() if outcome != "frames") > N_SHORT / 10, "the damage is too slight"


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_file_of_thousands_ends_a_reader(kind: str) -> None:
    assert len(fuzz(kind, N_SHORT, N_WHOLE)) > 1
