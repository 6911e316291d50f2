import csv
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from dropflow.cli import main

NAME = "water-isobutoxyethanol-illustrative"


@dataclass
class Done:
    code: int
    out: str
    err: str


@pytest.fixture
def dropflow(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    def run(*words: str) -> Done:
        monkeypatch.setattr(sys, "argv", ["dropflow", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return Done(int(ended.value.code or 0), said.out, said.err)

    return run


def test_material_prints_every_property_as_json(dropflow: Callable[..., Done]) -> None:
    done = dropflow("material", NAME, "--temperature-c", "40", "--composition", "0.25", "--json")
    assert done.code == 0, done.err
    report = json.loads(done.out)
    assert report["name"] == NAME
    assert report["properties"]["viscosity"]["unit"] == "Pa s"


def test_ramp_writes_a_row_a_second(tmp_path: Path, dropflow: Callable[..., Done]) -> None:
    output = tmp_path / "ramp.csv"
    done = dropflow("ramp", "--material", NAME, "--xi", "1e-3", "--output", str(output))
    assert done.code == 0, done.err
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
def test_what_cannot_be_is_one_line_and_exit_code_2(words: tuple[str, ...], dropflow: Callable[..., Done]) -> None:
    done = dropflow(*words)
    assert done.code == 2
    assert len(done.err.strip().splitlines()) == 1
    assert not Path("never.csv").exists()
