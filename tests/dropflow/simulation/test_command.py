from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from dropflow.cli import app
from dropflow.errors import ParametersError
from dropflow.frames import open_frames
from dropflow.simulation.scenario import Scenario

SMALL = ["--frames", "2", "--height", "96", "--width", "128"]


def _constants_of(out: Path) -> Scenario:
    return Scenario.model_validate(yaml.safe_load((out / "scenario.yaml").read_text())["scenario"])


def test_the_command_makes_a_film_that_can_be_read(tmp_path: Path) -> None:
    out = tmp_path / "film"
    run = CliRunner().invoke(app, ["simulate", str(out), "--scenario", "dark", "--seed", "3", *SMALL])
    assert run.exit_code == 0, run.output
    assert (_constants_of(out).name, _constants_of(out).is_dark) == ("dark", True)
    with open_frames(out / "frames") as frames:
        assert (len(frames), frames[1].shape) == (2, (96, 128))


def test_every_constant_is_an_option_with_its_help() -> None:
    shown = CliRunner().invoke(app, ["simulate", "--help"], env={"COLUMNS": "300", "TERM": "dumb"})
    for name in set(Scenario.model_fields) - {"name", "height_px", "width_px"}:
        assert f"--{name.replace('_', '-')} " in shown.output
    assert "Example: " in shown.output


def test_options_change_constants(tmp_path: Path) -> None:
    options = ["--opacity", "0.9", "--bit-depth", "12", "--droplets", "dark", "--kspread", "0.5", "--tables-only"]
    run = CliRunner().invoke(app, ["simulate", str(tmp_path / "film"), *SMALL, *options])
    assert run.exit_code == 0, run.output
    constants = _constants_of(tmp_path / "film")
    assert (constants.opacity, constants.bit_depth, constants.is_dark, constants.kspread) == (0.9, 12, True, 0.5)
    assert not (tmp_path / "film" / "frames").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--scenario", "misty"], "scenario: there is no 'misty'"),
        (["--opacity", "2"], "opacity: "),
        (["--frames", "0"], "frames: must be at least 1"),
        (["--height", "4"], "height_px: "),
    ],
)
def test_impossible_options_are_one_clear_error(tmp_path: Path, options: list[str], message: str) -> None:
    run = CliRunner().invoke(app, ["simulate", str(tmp_path / "film"), *options])
    assert isinstance(run.exception, ParametersError)
    assert message in str(run.exception)
    assert list(tmp_path.iterdir()) == []
