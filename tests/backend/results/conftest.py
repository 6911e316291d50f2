"""A run of a short film, and what the command makes of the same."""

from pathlib import Path

import pytest

from dropflow import analysis
from dropflow.experiment import parse_experiment
from dropflow.parameters import parse_parameters
from tests.films import EXPERIMENT, PARAMETERS, film
from tests.house import House, Json


@pytest.fixture(scope="module")
def run(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


@pytest.fixture(scope="package")
def by_command(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `dropflow analyse` makes of the same film."""
    folder = tmp_path_factory.mktemp("command")
    (folder / "frames").mkdir()
    for file in film():
        (folder / file.name).write_bytes(file.content)
    found = analysis.open_film(
        folder / "frames", parse_experiment(EXPERIMENT), parse_parameters(PARAMETERS), beside=folder
    )
    analysis.analyse(found, folder / "results", n_processes=1)
    return folder / "results"
