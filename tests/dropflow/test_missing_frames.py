"""Frames that cannot be read are left out where the experiment allows it, and results say so."""

import json
from pathlib import Path

import pytest

from dropflow.analysis import analyse, detect, open_film
from dropflow.errors import FramesError
from dropflow.experiment import parse_experiment
from dropflow.parameters import parse_parameters
from tests.films import EXPERIMENT, PARAMETERS, film


def test_the_command_leaves_out_broken_frames_where_the_experiment_allows_it(tmp_path: Path) -> None:
    stack = tmp_path / "frames"
    stack.mkdir()
    for index, file in enumerate(film(8)):
        (stack / f"{index}.tif").write_bytes(b"no image" if index == 4 else file.content)
    parameters = parse_parameters(PARAMETERS)
    strict = parse_experiment(EXPERIMENT)
    with pytest.raises(FramesError, match="not an image"):
        detect(open_film(stack, strict, parameters, beside=tmp_path), tmp_path / "d.parquet", n_processes=1)
    lenient = parse_experiment({**EXPERIMENT, "max_failed_frame_share": 0.2})
    analyse(open_film(stack, lenient, parameters, beside=tmp_path), tmp_path / "results", n_processes=1)
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert summary["missing_frames"] == [4]
    assert summary["warnings"][-1]["code"] == "frames.missing"
