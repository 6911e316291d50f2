"""`dropflow submit`: a film to a server, from its folder to a run."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.cli import progress
from dropflow.cli.options import ExperimentFile, ParametersFile, Stack
from dropflow.cli.server_options import ServerAddress, group_id
from dropflow.client import Client, Run
from dropflow.parameters import load_parameters


def submit(
    stack: Stack,
    experiment: ExperimentFile,
    parameters: ParametersFile = None,
    group: Annotated[str | None, typer.Option("--group", help="Name or id of the group it belongs to.")] = None,
    is_waiting: Annotated[bool, typer.Option("--wait", help="Wait for the end of the run.")] = False,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder for the results; waits for them.")
    ] = None,
    is_again: Annotated[bool, typer.Option("--again", help="Make another experiment of the same film.")] = False,
    server: ServerAddress = None,
) -> None:
    """Send a film to a server and start a run.

    Killed and started again, it goes on where it was, and makes neither a second experiment nor a second run: the
    same film, described alike, is the same experiment, and with the same parameters the same run.

    Example: `dropflow submit frames/ --experiment experiment.yaml --wait --output results/`
    """
    chosen = load_parameters(parameters).model_dump(mode="json", exclude_unset=True) if parameters else {}
    with Client(server) as client:
        owner = group_id(client, group)
        with progress.shown(in_bytes={"upload"}) as shown:
            run = client.submit(stack, experiment, parameters=chosen, group_id=owner, is_again=is_again, progress=shown)
        typer.echo(f"{'Run' if run.is_new else 'The run was there already:'} {run.id}  {run.url}")
        if is_waiting or output is not None:
            with progress.shown() as shown:
                run.wait(progress=shown)
            typer.echo(f"The run is completed after {_duration(run)}.")
        if output is not None:
            with progress.shown(in_bytes=None) as shown:
                run.fetch(output, progress=shown)
            typer.echo(f"Results are in {output}")


def _duration(run: Run) -> str:
    document = run.document
    if document.started_at is None or document.finished_at is None:
        return "no time"
    seconds = (document.finished_at - document.started_at).total_seconds()
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
