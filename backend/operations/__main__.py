"""`dropflow-server`: what whoever runs a server does with it."""

import json
import os
import sys
from pathlib import Path
from typing import Annotated

import typer
from alembic import command
from pydantic import ValidationError
from rich.console import Console
from rich.markup import escape
from sqlalchemy.exc import SQLAlchemyError

from backend.operations.backup import back_up
from backend.operations.doctor import Verdict, examine
from backend.operations.errors import OperationError
from backend.operations.migrated import alembic_config, is_migrated_within
from backend.operations.restore import restore
from backend.people.administrator import administrator as make_administrator
from backend.platform.database import make_engine, make_sessions
from backend.platform.object_store import ObjectStore
from backend.platform.reasons import reason_of
from backend.platform.settings import Settings, environment_settings
from dropflow.errors import DropflowError

app = typer.Typer(
    name="dropflow-server",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Run a Dropflow server. Settings are environment variables, the same as those of its services.",
)
_SIGNS = {Verdict.GOOD: "[green]good[/]", Verdict.DOUBTFUL: "[yellow]doubtful[/]", Verdict.BAD: "[red]bad[/]"}
BackupFolder = Annotated[Path, typer.Argument(help="Folder of the backups.")]


@app.command()
def doctor(*, as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line.")] = False) -> None:
    """Check each part and say what to mend. Ends with 1 if one is bad."""
    is_bad = False
    console = Console(highlight=False)
    for finding in examine(_settings()):
        is_bad |= finding.verdict == Verdict.BAD
        if as_json:
            sys.stdout.write(json.dumps(finding.as_json()) + "\n")
            continue
        console.print(f"{finding.part:13} {_SIGNS[finding.verdict]}  {escape(finding.found)}", soft_wrap=True)
        if finding.mend:
            console.print(f"{'':13} -> {escape(finding.mend)}", soft_wrap=True)
    raise typer.Exit(int(is_bad))


@app.command()
def migrate() -> None:
    """Bring the database to the form that this version needs."""
    os.environ["DATABASE_URL"] = _settings().database_url
    command.upgrade(alembic_config(), "head")


@app.command("await-database")
def await_database(
    seconds: Annotated[float, typer.Option(min=0, help="So long at most.")] = 600.0,
) -> None:
    """Wait until the database has the form that this version needs, as services do before they start."""
    engine = make_engine(_settings().database_url, application="dropflow-await")
    if not is_migrated_within(engine, seconds):
        raise OperationError(f"After {seconds:g} s the database is away or not migrated: see the migration's log.")


@app.command()
def administrator(
    email: Annotated[str, typer.Argument(help="Their e-mail address, with which they sign in.")],
    name: Annotated[str | None, typer.Option(help="What they are called; else the part before the @.")] = None,
) -> None:
    """Make somebody an administrator, with an account if they have none, and print a link that lets them in once."""
    settings = _settings()
    engine = make_engine(settings.database_url, application="dropflow-administrator")
    try:
        with make_sessions(engine).begin() as session:
            link = make_administrator(session, settings, email=email, name=name)
    finally:
        engine.dispose()
    typer.echo(link)


@app.command()
def backup(
    folder: BackupFolder,
    configuration: Annotated[list[Path] | None, typer.Option(help="A file or folder of settings to keep too.")] = None,
    keep: Annotated[int, typer.Option(min=1, help="So many backups stay in the folder.")] = 7,
) -> None:
    """Copy database, objects and configuration into FOLDER while the service runs; only new objects are copied."""
    settings = _settings()
    engine = make_engine(settings.database_url, application="dropflow-backup")
    store = ObjectStore(settings.object_store_url)
    made = back_up(engine, store, folder, configuration=configuration or (), n_kept=keep, report=_say)
    _say(f"finished: {made}")


@app.command("restore")
def restore_command(
    folder: BackupFolder,
    moment: Annotated[str | None, typer.Option(help="Which folder of FOLDER/moments, else the newest.")] = None,
) -> None:
    """Bring a backup into an empty database and object store, with the services stopped."""
    settings = _settings()
    engine = make_engine(settings.database_url, application="dropflow-restore")
    manifest = restore(engine, ObjectStore(settings.object_store_url), folder, moment=moment, report=_say)
    _say(f"restored what was on {manifest['made_at']}, made by Dropflow {manifest['version']}")


def _settings() -> Settings:
    try:
        return environment_settings()
    except ValidationError as error:
        first = error.errors()[0]
        name = "_".join(str(part) for part in first["loc"]).upper() or "The settings"
        raise OperationError(f"{name}: {first['msg']}") from None


def _say(text: str) -> None:
    sys.stderr.write(f"{text}\n")


def main() -> None:
    """Run a command; what is wrong is one line and exit code 2."""
    try:
        app()
    except (OperationError, DropflowError) as error:
        sys.exit(_failed(str(error)))
    except (SQLAlchemyError, OSError) as error:
        sys.exit(_failed(reason_of(error)))


def _failed(text: str) -> int:
    _say(f"dropflow-server: {text}")
    return 2


if __name__ == "__main__":
    main()
