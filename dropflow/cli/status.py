"""`dropflow status`: what goes on on the server."""

from itertools import islice
from typing import Annotated
from uuid import UUID

import typer

from dropflow.cli.server_options import ServerAddress
from dropflow.client import Client, Run


def status(
    run: Annotated[str | None, typer.Argument(metavar="[RUN]", help="Id or address of one run.")] = None,
    state: Annotated[
        str | None, typer.Option("--state", help="Only runs that are queued, running, completed, failed or cancelled.")
    ] = None,
    n_runs: Annotated[int, typer.Option("--limit", min=1, max=1000, help="Most runs to show.")] = 20,
    is_json: Annotated[bool, typer.Option("--json", help="Print JSON, one run a line.")] = False,
    server: ServerAddress = None,
) -> None:
    """Show the latest runs of all your experiments, or one run, and how far they are.

    Example: `dropflow status --state running`
    """
    with Client(server) as client:
        found = [client.runs.get(run)] if run else islice(client.runs.list(state=state), n_runs)
        names: dict[UUID, str] = {}
        for one in found:
            if is_json:
                typer.echo(one.document.model_dump_json())
                continue
            experiment = one.document.experiment_id
            if experiment not in names:
                names[experiment] = client.experiments.get(experiment).name
            typer.echo(
                f"{one.id}  {one.state:<9}  {_progress(one):<28}  {names[experiment]}, run {one.document.number}"
            )
            if run:
                _tell_more(one)


def _progress(run: Run) -> str:
    """What it is at, or what became of it."""
    for stage in run.document.stages:
        if stage.state == "running":
            left = "" if stage.seconds_left is None else f", {stage.seconds_left:.0f} s left"
            return f"{stage.name} {stage.done_frames}/{stage.total_frames}{left}"
    if run.document.problem is not None:
        return run.document.problem.code
    n_droplets = (run.summary or {}).get("detected", {}).get("n_droplets")
    return "" if n_droplets is None else f"{n_droplets} droplets"


def _tell_more(run: Run) -> None:
    for stage in run.document.stages:
        typer.echo(f"  {stage.name:<10} {stage.state:<10} {stage.done_frames}/{stage.total_frames}")
    if (problem := run.document.problem) is not None:
        typer.echo(f"  {problem.detail} {problem.hint or ''}".rstrip())
    for warning in run.document.warnings:
        typer.echo(f"  warning: {warning}")
    typer.echo(f"  {run.url}")
