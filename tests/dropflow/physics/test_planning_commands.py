import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

NAME = "water-isobutoxyethanol-illustrative"


def dropflow(*words: str) -> subprocess.CompletedProcess[str]:
    code = "import sys; from dropflow.cli import main; main()"
    return subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, timeout=120)


def test_material_prints_every_property_as_json() -> None:
    done = dropflow("material", NAME, "--temperature-c", "40", "--composition", "0.25", "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["name"] == NAME
    assert report["properties"]["viscosity"]["unit"] == "Pa s"


def test_ramp_writes_a_row_a_second(tmp_path: Path) -> None:
    output = tmp_path / "ramp.csv"
    done = dropflow("ramp", "--material", NAME, "--xi", "1e-3", "--output", str(output))
    assert done.returncode == 0, done.stderr
    with output.open() as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["temperature_c"]) == 25.8
    assert float(rows[-1]["temperature_c"]) == pytest.approx(50.0, abs=0.1)
    assert [float(row["time_s"]) for row in rows[:3]] == [0, 1, 2]


@pytest.mark.parametrize(
    "words",
    [
        ("material", "unobtainium"),
        ("material", NAME),
        ("material", NAME, "--temperature-c", "40", "--composition", "3"),
        ("ramp", "--material", NAME, "--output", "never.csv"),
        ("ramp", "--material", "air-in-water-25c", "--xi", "1e-5", "--output", "never.csv"),
    ],
)
def test_what_cannot_be_is_one_line_and_exit_code_2(words: tuple[str, ...]) -> None:
    done = dropflow(*words)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert not Path("never.csv").exists()
