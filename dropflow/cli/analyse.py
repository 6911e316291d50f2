"""`dropflow analyse`: from a stack to droplets, trajectories and the flow field."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.cli import progress
from dropflow.cli.compile import say_if_not_compiled
from dropflow.cli.options import ExperimentFile, Jobs, ParametersFile, Stack
from dropflow.experiment import load_experiment
from dropflow.parameters import Parameters, load_parameters


def analyse(
    stack: Stack,
    experiment: ExperimentFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.", show_default=False)],
    parameters: ParametersFile = None,
    jobs: Jobs = None,
) -> None:
    """Detect and track the droplets of a film and compute the flow field.

    Writes droplets.parquet (all detections), trajectories.parquet, rejected_trajectories.parquet, events.parquet
    (births, exits, coalescences), flow.zarr and summary.json. Killed and started again, it goes on where it was.

    Example: `dropflow analyse frames/ --experiment experiment.yaml --output results/`
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
        analysis.analyse(film, output, n_processes=jobs or analysis.available_processes(), progress=shown)
    typer.echo(f"Results are in {output}")
