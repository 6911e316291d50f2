"""What the commands that talk to a server share."""

from pathlib import Path
from typing import Annotated
from uuid import UUID

import typer

from dropflow.client import Client
from dropflow.client.errors import ClientError

ServerAddress = Annotated[
    str | None, typer.Option("--server", help="Address of the server [default: that of the last `dropflow login`].")
]


def group_id(client: Client, name: str | None) -> UUID | None:
    """The id of a group by its id or name."""
    if name is None:
        return None
    try:
        return UUID(name)
    except ValueError:
        groups = client.groups()
    found = [group.id for group in groups if group.name == name]
    if len(found) != 1:
        raise ClientError(
            f"There is {'no' if not found else 'more than one'} group {name}.",
            code="not_found.group",
            hint=f"Yours: {', '.join(group.name for group in groups)}.",
        )
    return found[0]


def is_results_folder(text: str) -> bool:
    """Whether an argument names a folder of results, not a run of a server."""
    return (Path(text) / "summary.json").is_file()
