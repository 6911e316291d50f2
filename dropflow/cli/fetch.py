"""`dropflow fetch`: the results of a run of the server."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.cli import progress
from dropflow.cli.server_options import ServerAddress
from dropflow.client import Client


def fetch(
    run: Annotated[str, typer.Argument(metavar="RUN", help="Id or address of a run.", show_default=False)],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.", show_default=False)],
    is_waiting: Annotated[bool, typer.Option("--wait", help="Wait for the end of the run first.")] = False,
    server: ServerAddress = None,
) -> None:
    """Bring the results of a run here, in the form in which `dropflow analyse` leaves them.

    Killed and started again, it goes on where it was; every file is checked against the server's checksum.

    Example: `dropflow fetch 5f0c6a2e-8f5d-4b7e-9a53-0b1d2c3e4f50 --output results/`
    """
    with Client(server) as client:
        found = client.runs.get(run)
        if is_waiting:
            with progress.shown() as shown:
                found.wait(progress=shown)
        with progress.shown(in_bytes=None) as shown:
            found.fetch(output, progress=shown)
    typer.echo(f"Results are in {output}")
