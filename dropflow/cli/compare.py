"""`dropflow compare`: the numbers of several runs side by side."""

import csv
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dropflow.cli.server_options import ServerAddress, is_results_folder
from dropflow.errors import DropflowError

if TYPE_CHECKING:
    from dropflow.client import Client

Json = dict[str, Any]


def compare(
    runs: Annotated[
        list[str], typer.Argument(metavar="RUN...", help="Ids or addresses of runs, or folders of results.")
    ],
    is_all: Annotated[bool, typer.Option("--all", help="Also show what is the same in all of them.")] = False,
    is_csv: Annotated[bool, typer.Option("--csv", help="Print CSV.")] = False,
    server: ServerAddress = None,
) -> None:
    """Show side by side in which numbers and parameters runs differ.

    Runs of a server and folders of results can be mixed.

    Example: `dropflow compare results/ 5f0c6a2e-8f5d-4b7e-9a53-0b1d2c3e4f50`
    """
    if len(runs) < 2:
        raise DropflowError("Give two runs or more.", code="compare.one_run")
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.statistics.side_by_side import flat

    columns = [dict(flat(summary)) for summary in _summaries(runs, server)]
    names = list(dict.fromkeys(name for column in columns for name in column))
    rows = [[name, *(_text(column.get(name)) for column in columns)] for name in names]
    shown = [row for row in rows if is_all or len(set(row[1:])) > 1]
    if is_csv:
        csv.writer(sys.stdout).writerows([["", *runs], *shown])
        return
    if not shown:
        typer.echo("They are the same in all numbers and parameters.")
        return
    _print([["", *(run if len(run) < 24 else f"...{run[-20:]}" for run in runs)], *shown])


def _summaries(runs: list[str], server: str | None) -> list[Json]:
    from dropflow.client import Client
    from dropflow.results import open_results

    folders = {run for run in runs if is_results_folder(run)}
    if len(folders) == len(set(runs)):
        return [open_results(Path(run)).summary for run in runs]
    with Client(server) as client:
        return [open_results(Path(run)).summary if run in folders else _summary(client, run) for run in runs]


def _summary(client: "Client", run: str) -> Json:
    from dropflow.client import WentWrong

    found = client.runs.get(run)
    if found.summary is None:
        raise WentWrong(f"The run {run} is {found.state}: it has no results.", code="client.not_yet")
    return found.summary


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return "" if value is None else value if isinstance(value, str) else json.dumps(value)


def _print(rows: list[list[str]]) -> None:
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    for first, *others in rows:
        cells = [first.ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))]
        typer.echo("  ".join(cells).rstrip())
