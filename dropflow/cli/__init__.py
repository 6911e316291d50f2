"""The `dropflow` command: one module a subcommand. Errors a user can cause are one line and exit code 2."""

import sys

import typer

from dropflow.cli.analyse import analyse
from dropflow.cli.detect import detect
from dropflow.cli.score import score
from dropflow.cli.simulate import simulate
from dropflow.errors import DropflowError
from dropflow.provenance import code_version

app = typer.Typer(
    name="dropflow",
    help="Sizes, paths and the flow field of polydisperse sedimenting droplets, from image stacks.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)
app.command()(analyse)
app.command()(detect)
app.command()(simulate)
app.command()(score)


def _show_version(is_wanted: bool) -> None:
    if is_wanted:
        typer.echo(f"dropflow {code_version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(False, "--version", callback=_show_version, is_eager=True, help="Show the version."),
) -> None:
    """Options of the command itself."""


def main() -> None:
    """Run the command."""
    try:
        app()
    except DropflowError as error:
        typer.echo(f"dropflow: {error} [{error.code}]", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        typer.echo("dropflow: stopped; started again, it goes on from here.", err=True)
        sys.exit(130)
