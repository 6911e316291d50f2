"""`dropflow detect`: from a stack to one table of droplets."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.cli import progress
from dropflow.cli.compile import say_if_not_compiled
from dropflow.cli.options import ExperimentFile, Jobs, ParametersFile, Stack
from dropflow.experiment import load_experiment
from dropflow.parameters import Parameters, load_parameters


def detect(
    stack: Stack,
    experiment: ExperimentFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="Parquet file to write.", show_default=False)],
    parameters: ParametersFile = None,
    jobs: Jobs = None,
) -> None:
    """Detect the droplets of every frame of a stack.

    Example: `dropflow detect frames/ --experiment experiment.yaml --output droplets.parquet`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow import analysis

    say_if_not_compiled()
    with progress.shown() as shown:
        film = analysis.open_film(
            stack,
            load_experiment(experiment),
            load_parameters(parameters) if parameters else Parameters(),
            beside=experiment.parent,
            progress=shown,
        )
        analysis.detect(film, output, n_processes=jobs or analysis.available_processes(), progress=shown)
    typer.echo(f"Droplets are in {output}")
