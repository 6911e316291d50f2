"""`dropflow submit`: a film to a server, from its folder to a run."""

from pathlib import Path
from typing import Annotated, Any

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
    root: Annotated[
        str | None,
        typer.Option("--import-from", help="STACK is a path below this import root of the server: nothing is sent."),
    ] = None,
    is_by_reference: Annotated[
        bool, typer.Option("--by-reference", help="With --import-from: leave the frames where they are.")
    ] = False,
    server: ServerAddress = None,
) -> None:
    """Send a film to a server and start a run.

    Killed and started again, it goes on where it was, and makes neither a second experiment nor a second run: the
    same film, described alike, is the same experiment, and with the same parameters the same run.

    Example: `dropflow submit frames/ --experiment experiment.yaml --wait --output results/`

    Frames that the server can read itself are imported: `dropflow submit "2024/run 1" --import-from microscope
    --experiment experiment.yaml`
    """
    chosen = load_parameters(parameters).model_dump(mode="json", exclude_unset=True) if parameters else {}
    with Client(server) as client:
        owner = group_id(client, group)
        with progress.shown(in_bytes={"upload", "import"}) as shown:
            about: dict[str, Any] = {"group_id": owner, "is_again": is_again, "progress": shown}
            if root is None:
                film = client.film(stack, experiment, **about)
            else:
                path = stack.as_posix().removeprefix("./")
                film = client.film_on_server(root, path, experiment, by_reference=is_by_reference, **about)
            run = film.start_once(chosen)
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
