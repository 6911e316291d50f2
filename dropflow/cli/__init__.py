"""The `dropflow` command: one module a subcommand. Errors a user can cause are one line and exit code 2."""

import os
import sys
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from dropflow.errors import DropflowError

# The arrays here are small: threads of a linear algebra library would wait for each other longer than they compute.
# It reads these when NumPy is loaded, which happens when a subcommand is.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

COMMANDS = (
    "analyse",
    "detect",
    "preview",
    "suggest",
    "simulate",
    "score",
    "compile",
    "material",
    "ramp",
    "report",
    "periods",
    "export",
    "login",
    "submit",
    "status",
    "fetch",
    "compare",
)
"""Each is a function of this name in the module of this name, in the order of the help."""


class _Commands(TyperGroup):
    """Imports a subcommand when it is asked for: numba and SciPy take seconds that no other one need wait."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        single = typer.Typer(add_completion=False, rich_markup_mode="markdown", pretty_exceptions_enable=False)
        single.command(cmd_name)(getattr(import_module(f"dropflow.cli.{cmd_name}"), cmd_name))
        return typer.main.get_command(single)


app = typer.Typer(
    cls=_Commands,
    name="dropflow",
    help="Sizes, paths and the flow field of polydisperse sedimenting droplets, from image stacks.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
)


def _show_version(is_wanted: bool) -> None:
    if is_wanted:
        from dropflow.provenance import code_version

        typer.echo(f"dropflow {code_version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(False, "--version", callback=_show_version, is_eager=True, help="Show the version."),
) -> None:
    """Options of the command itself."""


_UsageError: Any = typer.BadParameter.__bases__[0]
"""Base of what is wrong with options and arguments; typer gives it no public name."""


def main() -> None:
    """Run the command."""
    try:
        sys.exit(app(standalone_mode=False))
    except _UsageError as error:
        about = error.ctx.command_path if getattr(error, "ctx", None) else "dropflow"
        typer.echo(f"dropflow: {error.format_message()} Try '{about} --help'.", err=True)
        sys.exit(2)
    except DropflowError as error:
        typer.echo(f"dropflow: {error} [{error.code}]", err=True)
        sys.exit(2)
    except ImportError as error:
        if "dropflow[" not in str(error):
            raise  # a bug, not an extra that is not installed
        typer.echo(f"dropflow: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        typer.echo("dropflow: stopped; started again, it goes on from here.", err=True)
        sys.exit(130)
